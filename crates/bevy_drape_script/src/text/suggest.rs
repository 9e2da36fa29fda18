//! Suggests known words for misspelt ones.

/// The least similarity of two words, from 0 (none) to 1 (equal), for which one is suggested for the other.
const ALIKE: f64 = 0.8;

/// "; did you mean `curtain`?" if one of `known` resembles `found`; empty if none does.
pub(crate) fn did_you_mean<'a>(found: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(found, known).map_or_else(String::new, |nearest| format!("; did you mean `{nearest}`?"))
}

fn nearest<'a>(found: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let found = found.to_lowercase();
    let likeness = |word: &str| {
        let word = word.to_lowercase();
        // The first measure finds common beginnings (`dens` for `density`), the second swapped and wrong letters.
        strsim::jaro_winkler(&found, &word).max(strsim::normalized_damerau_levenshtein(&found, &word))
    };
    known
        .into_iter()
        .map(|word| (likeness(word), word))
        .filter(|&(likeness, _)| likeness >= ALIKE)
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, word)| word)
}

/// Adds a suggestion and the known names to `problem`: "nothing is called `canon`; did you mean `cannon`? There are:
/// cannon, curtain"
pub(crate) fn unknown(problem: &str, found: &str, known: &[impl AsRef<str>]) -> String {
    let names: Vec<&str> = known.iter().map(AsRef::as_ref).collect();
    if names.is_empty() {
        return format!("{problem}; there are none");
    }
    with_list(
        problem,
        &did_you_mean(found, names.iter().copied()),
        &format!("there are: {}", names.join(", ")),
    )
}

/// Adds a suggestion and the known fields to `problem`: "there is no field `pin` here; did you mean `pins`? The fields
/// are: `at`, `pins`"
pub(crate) fn unknown_field(problem: &str, found: &str, fields: &[&str]) -> String {
    let list = format!("the fields are: `{}`", fields.join("`, `"));
    with_list(problem, &did_you_mean(found, fields.iter().copied()), &list)
}

fn with_list(problem: &str, suggestion: &str, list: &str) -> String {
    if suggestion.is_empty() {
        return format!("{problem}; {list}");
    }
    let (first, rest) = list.split_at(1);
    format!("{problem}{suggestion} {}{rest}", first.to_uppercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_much_alike_is_suggested_and_nothing_else() {
        let known = ["particles", "pins", "present", "areal_density", "Fire", "Stretch"];
        for (found, meant) in [
            ("particle", "particles"),
            ("partilces", "particles"),
            ("pin", "pins"),
            ("fire", "Fire"),
            ("Stretc", "Stretch"),
            ("areal_densty", "areal_density"),
        ] {
            assert_eq!(nearest(found, known), Some(meant), "{found}");
        }
        for found in ["colour", "Shoot", "x", ""] {
            assert_eq!(nearest(found, known), None, "{found}");
        }
    }
}
