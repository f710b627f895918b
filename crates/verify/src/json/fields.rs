//! Fields of a line, each of the kind that is expected.

use super::Json;
use crate::Stop;
use crate::real::Real;

impl<'a> Json<'a> {
    /// Returns the first key of an object.
    pub(crate) fn kind(&self) -> &'a str {
        match self {
            Self::Object(all) => all.first().map_or("", |x| x.0),
            _ => "",
        }
    }

    /// Refuses fields that are not named.
    pub(crate) fn only(&self, known: &[&str]) -> Result<(), Stop> {
        let Self::Object(all) = self else {
            return Stop::bad("an object is expected");
        };
        match all.iter().find(|x| !known.contains(&x.0)) {
            Some((key, _)) => Stop::bad(format!("unknown field {key}")),
            None => Ok(()),
        }
    }

    pub(crate) fn find(&self, key: &str) -> Option<&Self> {
        let Self::Object(all) = self else { return None };
        all.iter().find(|x| x.0 == key).map(|x| &x.1)
    }

    pub(crate) fn get(&self, key: &str) -> Result<&Self, Stop> {
        self.find(key)
            .ok_or_else(|| Stop::Bad(format!("field {key} is missing")))
    }

    pub(crate) fn array(&self) -> Result<&[Self], Stop> {
        if let Self::Array(all) = self {
            Ok(all)
        } else {
            Stop::bad("a list is expected")
        }
    }

    pub(crate) fn list<const N: usize>(&self) -> Result<&[Self; N], Stop> {
        let all = self.array()?;
        all.try_into()
            .map_err(|_| Stop::Bad(format!("{N} entries are expected, not {}", all.len())))
    }

    pub(crate) fn text(&self) -> Result<&'a str, Stop> {
        if let Self::Text(text) = self {
            Ok(text)
        } else {
            Stop::bad("a text is expected")
        }
    }

    pub(crate) fn whole(&self) -> Result<usize, Stop> {
        if let Self::Whole(k) = self {
            Ok(*k)
        } else {
            Stop::bad("a whole number is expected")
        }
    }

    pub(crate) fn real(&self) -> Result<Real, Stop> {
        let text = self.text()?;
        let shown = || text.chars().take(40).collect::<String>();
        Real::parse(text).ok_or_else(|| Stop::Bad(format!("not a number in its written form: {}", shown())))
    }

    pub(crate) fn reals<const N: usize>(&self) -> Result<[Real; N], Stop> {
        let mut all = [Real::ZERO; N];
        for (real, json) in all.iter_mut().zip(self.list::<N>()?) {
            *real = json.real()?;
        }
        Ok(all)
    }
}
