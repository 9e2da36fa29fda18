//! What a parser's error means to the author of a scene: what was expected, and what was found.

use ron::error::{Error, Position, SpannedError};

use crate::SceneError;
use crate::hint::{Field, field};
use crate::suggest::{did_you_mean, unknown_field};
use crate::text::{Step, field_path, line_and_column};

/// The parser's error about the field at `path` of `text`, in words.
pub(crate) fn explain(error: &SpannedError, path: &[Step], text: &str) -> SceneError {
    let mut path = path.to_vec();
    let mut place = past_space(text, offset_of(text, &error.span.start));
    if let Error::MissingStructField { field, .. } = error.code {
        path.push(Step::Key(field.to_string()));
    }
    if is_about_a_value(&error.code) {
        // The parser may have read some of it already.
        place = start_of_value(text, place, offset_of(text, &error.span.start));
    }
    let found = Token::at(text, place);
    let field = field(&path);
    let problem = problem(&error.code, &path, field, found);
    let has_meaning = !is_about_the_form(&error.code, field);
    let problem = match field.filter(|_| has_meaning).and_then(Field::meaning) {
        Some(meaning) => format!("{problem} ({meaning})"),
        None => problem,
    };
    SceneError::of_field(field_path(&path), problem).at(line_and_column(text, found.start))
}

/// Whether one value was read where another was expected.
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

/// Whether it matters nothing what the field means: a name that there is not, a comma that is missing.
fn is_about_the_form(error: &Error, field: Option<Field>) -> bool {
    match error {
        Error::ExpectedComma
        | Error::ExpectedMapColon
        | Error::ExpectedStringEnd
        | Error::DuplicateStructField { .. }
        | Error::NoSuchStructField { .. } => true,
        Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) | Error::InvalidIdentifier(_) => {
            field.is_some_and(|field| !field.fields().is_empty())
        }
        _ => false,
    }
}

fn problem(error: &Error, path: &[Step], field: Option<Field>, found: Token) -> String {
    let wanted = field.and_then(Field::expected);
    let fields = field.map(Field::fields).unwrap_or_default();
    let word = found.word();
    let expected = |what: &str| format!("expected {what}, found {found}");
    let or = |usual: &str| wanted.clone().unwrap_or_else(|| usual.to_string());
    let quoted = || {
        let is_name = !word.is_empty() && !found.is_quoted() && word.starts_with(char::is_alphabetic);
        if is_name { format!("; did you mean `\"{word}\"`?") } else { String::new() }
    };
    let unclosed = |problem: String| format!("{problem}: is a bracket before it not closed?");
    match error {
        Error::Message(message) => message.clone(),
        Error::NoSuchEnumVariant { expected: variants, found: variant, .. } => {
            let known = or(&format!("one of `{}`", variants.join("`, `")));
            format!("expected {known}, found `{variant}`{}", did_you_mean(variant, variants.iter().copied()))
        }
        Error::NoSuchStructField { expected: fields, found: name, .. }
            if belongs_outside(path, found, fields) =>
        {
            unclosed(format!("there is no field `{name}` here"))
        }
        Error::NoSuchStructField { expected: fields, found: name, .. } => {
            unknown_field(&format!("there is no field `{name}` here"), name, fields)
        }
        Error::MissingStructField { field, .. } => format!("the field `{field}` is missing"),
        Error::DuplicateStructField { field, .. } => format!("the field `{field}` is given twice"),
        Error::ExpectedComma if found.follows_a_number() => {
            format!(
                "expected a {}number, found `{}`",
                if found.text.starts_with('.') { "whole " } else { "" },
                found.with_what_it_follows()
            )
        }
        Error::ExpectedComma if found.text == "(" => format!("`{}` holds nothing, found `(`", found.before()),
        Error::ExpectedComma => expected("`,` or a closing bracket"),
        Error::ExpectedMapColon => expected("`:` after a name"),
        Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) | Error::InvalidIdentifier(_)
            if !fields.is_empty() =>
        {
            if belongs_outside(path, found, &fields) {
                return unclosed(expected("the name of a field"));
            }
            unknown_field(&expected("the name of a field"), word, &fields)
        }
        Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) | Error::InvalidIdentifier(_) => {
            let variants = field.map(Field::choices).unwrap_or_default();
            format!("{}{}", expected(&or("a name")), did_you_mean(word, variants.iter().copied()))
        }
        Error::ExpectedStructLike | Error::ExpectedUnit => match path.last() {
            Some(Step::Variant(variant)) => {
                expected(&format!("`{variant}(..)` that holds {}", or("something")))
            }
            _ => expected(&or("`(`")),
        },
        Error::ExpectedStructLikeEnd | Error::ExpectedArrayEnd => wanted.map_or_else(
            || expected("a closing bracket"),
            |wanted| format!("expected {wanted}, found more: {found}"),
        ),
        Error::ExpectedDifferentLength { found, .. } => {
            format!("expected {}, found {found}", or("more values"))
        }
        Error::ExpectedString if field.is_some_and(Field::is_map) => {
            if belongs_outside(path, found, &fields) {
                return unclosed(expected("a name in quotes"));
            }
            format!("{}{}", expected("a name in quotes"), quoted())
        }
        Error::ExpectedString => format!("{}{}", expected(&or("a text in quotes")), quoted()),
        Error::InvalidValueForType { expected: kind, .. } => {
            let suggestion = if wanted.as_ref().is_some_and(|wanted| wanted.contains("text in quotes")) {
                quoted()
            } else {
                String::new()
            };
            format!("{}{suggestion}", expected(&or(kind)))
        }
        Error::ExpectedNamedStructLike(_) | Error::ExpectedDifferentStructName { .. } => {
            expected(&or("fields in round brackets"))
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
        | Error::UnderscoreAtBeginning => expected(&or("something else")),
        Error::Eof => "the text ends before the scene does: a bracket is not closed".to_string(),
        Error::ExpectedStringEnd => "this text in quotes does not end".to_string(),
        Error::UnclosedBlockComment => "a comment that begins with `/*` does not end".to_string(),
        Error::TrailingCharacters => expected("nothing after the last bracket"),
        Error::ExceededRecursionLimit => "this is nested too deeply".to_string(),
        other => other.to_string(),
    }
}

/// Whether what was found is like none of `fields`, and could stand in one of the brackets around that at `path`.
fn belongs_outside(path: &[Step], found: Token, fields: &[&str]) -> bool {
    let is_alike = !did_you_mean(found.word(), fields.iter().copied()).is_empty();
    !is_alike
        && (0..path.len()).filter_map(|around| field(&path[..around])).any(|around| {
            if found.is_quoted() { around.is_map() } else { around.fields().contains(&found.word()) }
        })
}

/// The offset of a position that counts characters.
fn offset_of(text: &str, position: &Position) -> usize {
    let line: usize = text.split_inclusive('\n').take(position.line.saturating_sub(1)).map(str::len).sum();
    let rest = &text[line..];
    line + rest.char_indices().nth(position.col.saturating_sub(1)).map_or(rest.len(), |(offset, _)| offset)
}

/// The first offset from `place` on at which there is neither space nor a comment.
fn past_space(text: &str, mut place: usize) -> usize {
    loop {
        let rest = &text[place..];
        let trimmed = rest.trim_start();
        place += rest.len() - trimmed.len();
        let comment = if trimmed.starts_with("//") {
            trimmed.find('\n')
        } else if trimmed.starts_with("/*") {
            trimmed.find("*/").map(|end| end + 2)
        } else {
            None
        };
        match comment {
            Some(length) => place += length,
            None => return place,
        }
    }
}

fn is_part_of_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-')
}

/// Where the value begins of which the parser has read up to `read`, with nothing but space between that and `place`.
fn start_of_value(text: &str, place: usize, read: usize) -> usize {
    let before = &text[..read];
    if text[..read].ends_with('"') && !text[place..].starts_with('"') {
        return read - 1;
    }
    let word: usize = before.chars().rev().take_while(|&c| is_part_of_word(c)).map(char::len_utf8).sum();
    if word > 0 { read - word } else { place }
}

/// What was found: a word, a number, a text in quotes or a sign; nothing at the end.
#[derive(Clone, Copy)]
struct Token<'a> {
    whole: &'a str,
    start: usize,
    text: &'a str,
}

/// What is longer is cut off in messages, in characters.
const LONGEST: usize = 32;

impl<'a> Token<'a> {
    fn at(whole: &'a str, start: usize) -> Self {
        let rest = &whole[start..];
        let length = match rest.chars().next() {
            None => 0,
            Some('"') => rest[1..].find(['"', '\n']).map_or(rest.len(), |end| end + 2),
            Some(c) if is_part_of_word(c) => rest.find(|c| !is_part_of_word(c)).unwrap_or(rest.len()),
            Some(c) => c.len_utf8(),
        };
        Self { whole, start, text: rest[..length.min(rest.len())].trim_end() }
    }

    fn is_quoted(&self) -> bool {
        self.text.starts_with('"')
    }

    /// The word without its quotes.
    fn word(&self) -> &'a str {
        self.text.trim_matches('"')
    }

    /// The word that ends where it begins.
    fn before(&self) -> &'a str {
        let before = &self.whole[..self.start];
        before
            .rfind(|c| !is_part_of_word(c))
            .map_or(before, |end| &before[end..])
            .trim_start_matches(|c| !is_part_of_word(c))
    }

    fn follows_a_number(&self) -> bool {
        self.before().starts_with(|c: char| c.is_ascii_digit() || c == '-')
            && self.text.starts_with(is_part_of_word)
    }

    fn with_what_it_follows(&self) -> &'a str {
        let start = self.start - self.before().len();
        &self.whole[start..self.start + self.text.len()]
    }
}

impl core::fmt::Display for Token<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter) -> core::fmt::Result {
        if self.text.is_empty() {
            return f.write_str("the end of the text");
        }
        let shown: String = self.text.chars().take(LONGEST).collect();
        let rest = if shown.len() < self.text.len() { ".." } else { "" };
        write!(f, "`{shown}{rest}`")
    }
}
