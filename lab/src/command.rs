//! The frame of a program with options.

use std::fmt::Display;
use std::process::ExitCode;

/// Runs with the options of the command line: `parsed` is those, nothing where help is asked for, or what is wrong with them.
/// Success, failure, or 2 for a wrong call.
pub fn main<O, W: Display, T: Display>(
    name: &str,
    usage: &str,
    parsed: Result<Option<O>, W>,
    run: impl FnOnce(&O) -> Result<(), T>,
) -> ExitCode {
    match parsed {
        Ok(Some(options)) => match run(&options) {
            Ok(()) => ExitCode::SUCCESS,
            Err(why) => {
                eprintln!("{name}: {why}");
                ExitCode::FAILURE
            }
        },
        Ok(None) => {
            println!("{usage}");
            ExitCode::SUCCESS
        }
        Err(why) => {
            eprintln!("{name}: {why}\n\n{usage}");
            ExitCode::from(2)
        }
    }
}

/// The words of a command line, from which a program takes its options one by one.
#[derive(Debug)]
pub struct Arguments {
    words: Vec<String>,
}

impl Arguments {
    /// Returns the arguments of the process; `None` if help is requested.
    pub fn of_process() -> Option<Self> {
        Self::new(std::env::args().skip(1))
    }

    /// Returns the given words; `None` if `-h` or `--help` is among them.
    pub fn new(words: impl IntoIterator<Item = String>) -> Option<Self> {
        let words: Vec<String> = words.into_iter().collect();
        let asks_help = words.iter().any(|w| w == "-h" || w == "--help");
        (!asks_help).then_some(Self { words })
    }

    /// Returns whether the switch `name` is there, and takes it.
    pub fn flag(&mut self, name: &str) -> bool {
        let at = self.words.iter().position(|w| w == name);
        at.map(|k| self.words.remove(k)).is_some()
    }

    /// Returns the word after `name` and takes both.
    ///
    /// # Errors
    /// `name` is the last word.
    pub fn value(&mut self, name: &str) -> Result<Option<String>, String> {
        let Some(k) = self.words.iter().position(|w| w == name) else {
            return Ok(None);
        };
        if k + 1 == self.words.len() {
            return Err(format!("{name} needs a value"));
        }
        let value = self.words.remove(k + 1);
        self.words.remove(k);
        Ok(Some(value))
    }

    /// Returns the number after `name`, which must be at least `least`; `default` if the option is
    /// not given.
    ///
    /// # Errors
    /// The word after `name` is missing, not a number, or too small.
    pub fn number<T>(&mut self, name: &str, least: T, default: T) -> Result<T, String>
    where
        T: std::str::FromStr + PartialOrd + Display,
    {
        let Some(word) = self.value(name)? else {
            return Ok(default);
        };
        let number = word.parse().ok().filter(|x| *x >= least);
        number.ok_or(format!("{name} needs a number of at least {least}, not {word}"))
    }

    /// Returns the words that are left, unchecked.
    pub fn rest(self) -> Vec<String> {
        self.words
    }

    /// Returns the words that are left: files.
    ///
    /// # Errors
    /// A word begins with a dash, or there are more than `most` words.
    pub fn files(self, most: usize) -> Result<Vec<String>, String> {
        match self.words.iter().find(|w| w.starts_with('-')) {
            Some(word) => Err(format!("{word} is not an option")),
            None if self.words.len() > most => Err(format!("{} is not expected", self.words[most])),
            None => Ok(self.words),
        }
    }
}

/// Refuses a path that cannot be written, before long work; makes its folder, and leaves what the file holds.
///
/// # Errors
/// The folder or the file cannot be written; the text names which.
pub fn writable(path: &std::path::Path) -> Result<(), String> {
    let named = |e: std::io::Error| format!("{}: {e}", path.display());
    if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(named)?;
    }
    let is_new = !path.exists();
    std::fs::OpenOptions::new()
        .append(true)
        .create(true)
        .open(path)
        .map_err(named)?;
    if is_new {
        std::fs::remove_file(path).map_err(named)?;
    }
    Ok(())
}

/// Writes `text` to `path` and makes its folder.
///
/// # Errors
/// The folder or the file cannot be written; the text names which.
pub fn write(path: &std::path::Path, text: &str) -> Result<(), String> {
    writable(path)?;
    std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(line: &str) -> Arguments {
        Arguments::new(line.split(' ').map(str::to_owned)).expect("no help is asked for")
    }

    #[test]
    fn options_are_taken_in_any_order() {
        let mut a = of("--quick a.stl --frames 20 b.stl");
        assert_eq!(a.number("--frames", 1, 7), Ok(20));
        assert!(a.flag("--quick") && !a.flag("--quick"));
        assert_eq!(a.value("--out"), Ok(None));
        assert_eq!(a.files(2), Ok(vec!["a.stl".to_owned(), "b.stl".to_owned()]));
    }

    #[test]
    fn nonsense_is_named() {
        assert!(
            of("--frames -3")
                .number("--frames", 1, 7)
                .is_err_and(|e| e.contains("-3"))
        );
        assert!(
            of("--frames x")
                .number("--frames", 1, 7)
                .is_err_and(|e| e.contains('x'))
        );
        assert!(of("--out").value("--out").is_err());
        assert!(of("--nonsense").files(2).is_err_and(|e| e.contains("--nonsense")));
        assert!(of("a b c").files(2).is_err_and(|e| e.contains('c')));
        assert!(Arguments::new(["-h".to_owned()]).is_none());
    }
}
