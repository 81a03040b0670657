//! Reads text files line by line, in bounded memory, with errors that name the line.

use std::io::{self, BufRead, Read};
use std::str::FromStr;

/// Longest line accepted, in bytes: a polygon of ten thousand corners fits, a binary file that
/// never breaks its line does not fill the memory.
const LONGEST_LINE: u64 = 1 << 20;

/// Longest excerpt of a line shown in a message, in characters.
const EXCERPT: usize = 60;

/// Error of a text that cannot be read.
#[derive(Debug)]
pub(crate) enum TextError {
    /// The reader failed.
    Io(io::Error),
    /// The text breaks the format's rules.
    Syntax {
        /// Line number, from 1.
        line: usize,
        /// Description of the fault, with the offending text.
        message: String,
    },
}

/// A line without its comment and surrounding white space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line<'a> {
    /// Line number, from 1.
    pub number: usize,
    /// Rest of the text.
    pub text: &'a str,
}

/// The lines of a reader.
pub(crate) struct Lines<R> {
    reader: R,
    number: usize,
    buffer: String,
}

impl<R: BufRead> Lines<R> {
    pub fn new(reader: R) -> Self {
        Self {
            reader,
            number: 0,
            buffer: String::new(),
        }
    }

    /// Number of the last line read.
    pub fn number(&self) -> usize {
        self.number
    }

    /// The next line that is neither blank nor a `#` comment.
    pub fn next_line(&mut self) -> Result<Option<Line<'_>>, TextError> {
        loop {
            let mut bytes = Vec::new();
            let mut limited = Read::take(&mut self.reader, LONGEST_LINE);
            let count = limited
                .read_until(b'\n', &mut bytes)
                .map_err(TextError::Io)?;
            if count == 0 {
                return Ok(None);
            }
            self.number += 1;
            if count as u64 == LONGEST_LINE && bytes.last() != Some(&b'\n') {
                return Err(TextError::Syntax {
                    line: self.number,
                    message: format!("the line is longer than {LONGEST_LINE} bytes"),
                });
            }
            let text = String::from_utf8_lossy(&bytes);
            let content = text.split('#').next().unwrap_or_default().trim();
            if !content.is_empty() {
                self.buffer = content.to_owned();
                return Ok(Some(Line {
                    number: self.number,
                    text: &self.buffer,
                }));
            }
        }
    }
}

impl Line<'_> {
    /// An error at this line.
    pub fn error(&self, message: impl Into<String>) -> TextError {
        TextError::Syntax {
            line: self.number,
            message: message.into(),
        }
    }

    /// The next token as a number; `what` names it in the error.
    pub fn parse<'t, T: FromStr>(
        &self,
        tokens: &mut impl Iterator<Item = &'t str>,
        what: &str,
    ) -> Result<T, TextError> {
        let Some(token) = tokens.next() else {
            return Err(self.error(format!("{what} is missing in {}", quote(self.text))));
        };
        token.parse().map_err(|_| {
            let line = quote(self.text);
            self.error(format!(
                "cannot read {what} from {} in {line}",
                quote(token)
            ))
        })
    }

    /// The next token as a finite number.
    pub fn finite<'t>(
        &self,
        tokens: &mut impl Iterator<Item = &'t str>,
        what: &str,
    ) -> Result<f32, TextError> {
        let value: f32 = self.parse(tokens, what)?;
        if value.is_finite() {
            return Ok(value);
        }
        Err(self.error(format!("{what} is {value} in {}", quote(self.text))))
    }
}

/// A piece of a text for a message: quoted, escaped, cut.
pub(crate) fn quote(text: &str) -> String {
    let mut excerpt: String = text.chars().take(EXCERPT).collect();
    if excerpt.len() < text.len() {
        excerpt.push('…');
    }
    format!("{excerpt:?}")
}
