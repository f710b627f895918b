//! What the races of pairs and of contacts share.

use std::io::Write;
use std::time::Duration;

/// How long an engine runs before a pass of it counts.
pub(crate) const WARM_UP: Duration = Duration::from_millis(3);

pub(crate) struct Options {
    csv: Option<String>,
    pub(crate) quick: bool,
    pub(crate) only: Option<String>,
}

impl Options {
    pub(crate) fn of(words: &[String]) -> Option<Self> {
        let mut o = Options {
            csv: None,
            quick: false,
            only: None,
        };
        let mut words = words.iter();
        while let Some(word) = words.next() {
            match word.as_str() {
                "--csv" => o.csv = Some(words.next()?.clone()),
                "--quick" => o.quick = true,
                "--only" => o.only = Some(words.next()?.clone()),
                _ => return None,
            }
        }
        Some(o)
    }

    /// Writes the file asked for: scene, shape, n, engine and time of each line.
    pub(crate) fn write<'a>(&self, lines: impl Iterator<Item = (&'a str, &'a str, usize, &'a str, f64)>) {
        let Some(file) = &self.csv else { return };
        let write = || -> std::io::Result<()> {
            let mut out = std::fs::File::create(file)?;
            writeln!(out, "scene,shape,n,engine,ns")?;
            for (scene, shape, n, engine, ns) in lines {
                writeln!(out, "{scene},{shape},{n},{engine},{ns:.1}")?;
            }
            Ok(())
        };
        if let Err(e) = write() {
            eprintln!("{file}: {e}");
            std::process::exit(1);
        }
    }
}

pub(crate) fn median(list: &mut [f64]) -> f64 {
    list.sort_by(f64::total_cmp);
    list[list.len() / 2]
}
