//! Lists of fixed length, in round or square brackets.

use core::fmt;
use core::marker::PhantomData;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// Deserializes values in round brackets, as in `(2, 1.5)`, or in square ones, as in `[2, 1.5]`.
pub(crate) fn bracketed<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<T, D::Error> {
    struct Bracketed<T>(PhantomData<T>);

    impl<'de, T: Deserialize<'de>> Visitor<'de> for Bracketed<T> {
        type Value = T;

        fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
            formatter.write_str("values in brackets")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, items: A) -> Result<T, A::Error> {
            T::deserialize(SeqAccessDeserializer::new(items))
        }
    }

    deserializer.deserialize_any(Bracketed(PhantomData))
}
