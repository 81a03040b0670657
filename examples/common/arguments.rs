//! Command line options of an example, without a parser crate.

use std::str::FromStr;

/// What stands behind the program's name and was not taken yet.
pub struct Arguments(Vec<String>);

impl Arguments {
    /// The arguments that the program was started with.
    pub fn from_env() -> Self {
        Self(std::env::args().skip(1).collect())
    }

    /// Takes `--name`; false where it is not given.
    pub fn flag(&mut self, name: &str) -> bool {
        let place = self.0.iter().position(|a| a == name);
        place.map(|k| self.0.remove(k)).is_some()
    }

    /// Takes `--name VALUE`; `None` where it is not given.
    pub fn value<T: FromStr>(&mut self, name: &str) -> Result<Option<T>, String> {
        let Some(place) = self.0.iter().position(|a| a == name) else {
            return Ok(None);
        };
        self.0.remove(place);
        if place == self.0.len() {
            return Err(format!("{name} needs a value"));
        }
        let value = self.0.remove(place);
        let parsed = value.parse().map(Some);
        parsed.map_err(|_| format!("{name} cannot be `{value}`"))
    }

    /// Refuses what no option took.
    pub fn finish(self) -> Result<(), String> {
        match self.0.first() {
            None => Ok(()),
            Some(unknown) => Err(format!("unknown argument `{unknown}`")),
        }
    }
}
