//! Errors for data that allow no fit.

use thiserror::Error;

use crate::samples::record::Reference;

/// The reason why no cable can be identified from the data.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{cause}")]
pub struct FitError {
    /// One sentence without its full stop.
    pub cause: String,
    /// What to do, one sentence; without a full stop if `instead` continues it.
    pub advice: &'static str,
    /// The reference to fit to instead.
    pub instead: Option<Reference>,
}

impl FitError {
    pub(crate) fn new(cause: impl Into<String>, advice: &'static str) -> Self {
        Self { cause: cause.into(), advice, instead: None }
    }

    /// Returns what to do, if anything. `option` formats the choice of a reference in the caller's syntax.
    #[must_use]
    pub fn advice(&self, option: impl Fn(Reference) -> String) -> Option<String> {
        let advice = (!self.advice.is_empty()).then(|| self.advice.to_owned())?;
        Some(self.instead.map_or(advice.clone(), |reference| format!("{advice}: {}.", option(reference))))
    }
}
