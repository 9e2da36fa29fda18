//! The word, number or sign at an offset of a text.

fn is_part_of_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-')
}

/// The start of a value that the parser has read up to `read`. Between `read` and `offset` there is only white space.
pub(super) fn start_of_value(text: &str, offset: usize, read: usize) -> usize {
    let before = &text[..read];
    if text[..read].ends_with('"') && !text[offset..].starts_with('"') {
        return read - 1;
    }
    let word: usize = before.chars().rev().take_while(|&c| is_part_of_word(c)).map(char::len_utf8).sum();
    if word > 0 { read - word } else { offset }
}

/// A word, a number, a text in quotes or a sign; empty at the end of the text.
#[derive(Clone, Copy)]
pub(super) struct Token<'a> {
    whole: &'a str,
    pub start: usize,
    pub text: &'a str,
}

/// Longer tokens are cut off in messages, in characters.
const LONGEST: usize = 32;

impl<'a> Token<'a> {
    pub fn at(whole: &'a str, start: usize) -> Self {
        let rest = &whole[start..];
        let length = match rest.chars().next() {
            None => 0,
            Some('"') => rest[1..].find(['"', '\n']).map_or(rest.len(), |end| end + 2),
            Some(c) if is_part_of_word(c) => rest.find(|c| !is_part_of_word(c)).unwrap_or(rest.len()),
            Some(c) => c.len_utf8(),
        };
        Self { whole, start, text: rest[..length.min(rest.len())].trim_end() }
    }

    pub fn is_quoted(&self) -> bool {
        self.text.starts_with('"')
    }

    /// The word without its quotes.
    pub fn word(&self) -> &'a str {
        self.text.trim_matches('"')
    }

    /// The word that ends at its start.
    pub fn word_before(&self) -> &'a str {
        let before = &self.whole[..self.start];
        before
            .rfind(|c| !is_part_of_word(c))
            .map_or(before, |end| &before[end..])
            .trim_start_matches(|c| !is_part_of_word(c))
    }

    pub fn follows_a_number(&self) -> bool {
        self.word_before().starts_with(|c: char| c.is_ascii_digit() || c == '-')
            && self.text.starts_with(is_part_of_word)
    }

    /// The token with the word before it.
    pub fn with_word_before(&self) -> &'a str {
        let start = self.start - self.word_before().len();
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
