//! Translates the parser's errors into words for the author of a scene: what was expected, and what was found.

use ron::error::{Error, SpannedError};

use super::error::SceneError;
use super::path::{PathStep, field_path};
use super::position::{line_and_column, offset_of, past_space};
use super::schema::{Field, Schema};
use super::suggest::{did_you_mean, unknown_field};
use super::token::{Token, start_of_value};

/// Explains the parser's error about the field at `path` of `text`.
pub(crate) fn explain(error: &SpannedError, path: &[PathStep], text: &str, schema: &Schema) -> SceneError {
    let mut path = path.to_vec();
    let mut offset = past_space(text, offset_of(text, &error.span.start));
    if let Error::MissingStructField { field, .. } = error.code {
        path.push(PathStep::Key(field.to_string()));
    }
    if is_about_a_value(&error.code) {
        // The parser may have read some of it already.
        offset = start_of_value(text, offset, offset_of(text, &error.span.start));
    }
    let mistake = Mistake { schema, path: &path, field: schema.field(&path), found: Token::at(text, offset) };
    let problem = mistake.problem(&error.code);
    let has_meaning = !mistake.is_about_the_form(&error.code);
    let problem = match mistake.field.filter(|_| has_meaning).and_then(Field::meaning) {
        Some(meaning) => format!("{problem} ({meaning})"),
        None => problem,
    };
    SceneError::of_field(field_path(&path), problem).at(line_and_column(text, mistake.found.start))
}

/// True if one value was read and another one expected.
fn is_about_a_value(error: &Error) -> bool {
    matches!(
        error,
        Error::InvalidValueForType { .. }
            | Error::ExpectedString
            | Error::ExpectedFloat
            | Error::ExpectedInteger
            | Error::IntegerOutOfBounds
    )
}

/// A place in a file at which the parser stopped.
struct Mistake<'a> {
    schema: &'a Schema,
    path: &'a [PathStep],
    /// The field at `path`, if the schema has it.
    field: Option<Field<'a>>,
    found: Token<'a>,
}

impl Mistake<'_> {
    /// True if the meaning of the field does not help: an unknown name, a missing comma.
    fn is_about_the_form(&self, error: &Error) -> bool {
        match error {
            Error::ExpectedComma
            | Error::ExpectedMapColon
            | Error::ExpectedStringEnd
            | Error::DuplicateStructField { .. }
            | Error::NoSuchStructField { .. } => true,
            Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) | Error::InvalidIdentifier(_) => {
                self.field.is_some_and(|field| !field.fields().is_empty())
            }
            _ => false,
        }
    }

    fn problem(&self, error: &Error) -> String {
        self.problem_of_name(error)
            .or_else(|| self.problem_of_brackets(error))
            .unwrap_or_else(|| self.problem_of_value(error))
    }

    /// The problem with the name of a field or variant, if `error` is about one.
    fn problem_of_name(&self, error: &Error) -> Option<String> {
        let Self { found, field, .. } = self;
        let fields = field.map(Field::fields).unwrap_or_default();
        Some(match error {
            Error::NoSuchEnumVariant { expected: variants, found: variant, .. } => {
                let known = self.wanted_or(&format!("one of `{}`", variants.join("`, `")));
                let suggestion = did_you_mean(variant, variants.iter().copied());
                format!("expected {known}, found `{variant}`{suggestion}")
            }
            Error::NoSuchStructField { expected: fields, found: name, .. } => {
                let problem = format!("there is no field `{name}` here");
                if self.belongs_outside(fields) {
                    unclosed(&problem)
                } else {
                    unknown_field(&problem, name, fields)
                }
            }
            Error::MissingStructField { field, .. } => format!("the field `{field}` is missing"),
            Error::DuplicateStructField { field, .. } => format!("the field `{field}` is given twice"),
            Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) | Error::InvalidIdentifier(_)
                if !fields.is_empty() =>
            {
                let problem = self.expected("the name of a field");
                if self.belongs_outside(&fields) {
                    unclosed(&problem)
                } else {
                    unknown_field(&problem, found.word(), &fields)
                }
            }
            Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) | Error::InvalidIdentifier(_) => {
                let variants = field.map(Field::choices).unwrap_or_default();
                let suggestion = did_you_mean(found.word(), variants.iter().copied());
                format!("{}{suggestion}", self.expected(&self.wanted_or("a name")))
            }
            Error::ExpectedString if field.is_some_and(Field::is_map) => {
                let problem = self.expected("a name in quotes");
                if self.belongs_outside(&fields) {
                    unclosed(&problem)
                } else {
                    format!("{problem}{}", self.quotes_suggested())
                }
            }
            _ => return None,
        })
    }

    /// The problem with brackets, commas, quotes or comments, if `error` is about them.
    fn problem_of_brackets(&self, error: &Error) -> Option<String> {
        let found = self.found;
        Some(match error {
            Error::ExpectedComma if found.follows_a_number() => {
                format!(
                    "expected a {}number, found `{}`",
                    if found.text.starts_with('.') { "whole " } else { "" },
                    found.with_word_before()
                )
            }
            Error::ExpectedComma if found.text == "(" => {
                format!("`{}` holds nothing, found `(`", found.word_before())
            }
            Error::ExpectedComma => self.expected("`,` or a closing bracket"),
            Error::ExpectedMapColon => self.expected("`:` after a name"),
            Error::ExpectedStructLike | Error::ExpectedUnit => match self.path.last() {
                Some(PathStep::Variant(variant)) => {
                    self.expected(&format!("`{variant}(..)` that holds {}", self.wanted_or("something")))
                }
                _ => self.expected(&self.wanted_or("`(`")),
            },
            Error::ExpectedStructLikeEnd | Error::ExpectedArrayEnd => self.wanted().map_or_else(
                || self.expected("a closing bracket"),
                |wanted| format!("expected {wanted}, found more: {found}"),
            ),
            Error::ExpectedNamedStructLike(_) | Error::ExpectedDifferentStructName { .. } => {
                self.expected(&self.wanted_or("fields in round brackets"))
            }
            Error::Eof => "the text ends before the scene does: a bracket is not closed".to_string(),
            Error::ExpectedStringEnd => "this text in quotes does not end".to_string(),
            Error::UnclosedBlockComment => "a comment that begins with `/*` does not end".to_string(),
            Error::TrailingCharacters => self.expected("nothing after the last bracket"),
            Error::ExceededRecursionLimit => "this is nested too deeply".to_string(),
            _ => return None,
        })
    }

    fn problem_of_value(&self, error: &Error) -> String {
        match error {
            Error::Message(message) => message.clone(),
            Error::ExpectedDifferentLength { found, .. } => {
                format!("expected {}, found {found}", self.wanted_or("more values"))
            }
            Error::ExpectedString => {
                format!("{}{}", self.expected(&self.wanted_or("a text in quotes")), self.quotes_suggested())
            }
            Error::InvalidValueForType { expected: kind, .. } => {
                let is_text = self.wanted().is_some_and(|wanted| wanted.contains("text in quotes"));
                let suggestion = if is_text { self.quotes_suggested() } else { String::new() };
                format!("{}{suggestion}", self.expected(&self.wanted_or(kind)))
            }
            Error::ExpectedArray
            | Error::ExpectedBoolean
            | Error::ExpectedFloat
            | Error::ExpectedInteger
            | Error::IntegerOutOfBounds
            | Error::InvalidIntegerDigit { .. }
            | Error::ExpectedMap
            | Error::ExpectedOption
            | Error::UnexpectedChar(_)
            | Error::FloatUnderscore
            | Error::UnderscoreAtBeginning => self.expected(&self.wanted_or("something else")),
            other => other.to_string(),
        }
    }

    fn expected(&self, wanted: &str) -> String {
        format!("expected {wanted}, found {}", self.found)
    }

    /// The values that the schema allows here.
    fn wanted(&self) -> Option<String> {
        self.field.and_then(Field::expected)
    }

    fn wanted_or(&self, usual: &str) -> String {
        self.wanted().unwrap_or_else(|| usual.to_string())
    }

    /// Suggests the quotes that are missing around a word.
    fn quotes_suggested(&self) -> String {
        let word = self.found.word();
        let is_name = !word.is_empty() && !self.found.is_quoted() && word.starts_with(char::is_alphabetic);
        if is_name { format!("; did you mean `\"{word}\"`?") } else { String::new() }
    }

    /// True if the token resembles none of `fields`, and is a field of one of the values around this one.
    fn belongs_outside(&self, fields: &[&str]) -> bool {
        let Self { schema, path, found, .. } = self;
        let is_alike = !did_you_mean(found.word(), fields.iter().copied()).is_empty();
        !is_alike
            && (0..path.len()).filter_map(|around| schema.field(&path[..around])).any(|around| {
                if found.is_quoted() { around.is_map() } else { around.fields().contains(&found.word()) }
            })
    }
}

fn unclosed(problem: &str) -> String {
    format!("{problem}: is a bracket before it not closed?")
}
