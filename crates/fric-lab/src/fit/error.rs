//! Why data allow no fit.

use thiserror::Error;

use crate::samples::record::Reference;

/// Data that no cable can be identified from.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{cause}")]
pub struct FitError {
    /// In one sentence, without its full stop.
    pub cause: String,
    /// What to do, a sentence; it ends without a full stop where `instead` says more.
    pub advice: &'static str,
    /// The reference to fit to instead.
    pub instead: Option<Reference>,
}

impl FitError {
    pub(crate) fn new(cause: impl Into<String>, advice: &'static str) -> Self {
        Self { cause: cause.into(), advice, instead: None }
    }

    /// What to do, if anything; `option` writes the choice of a reference as the caller has to.
    #[must_use]
    pub fn advice(&self, option: impl Fn(Reference) -> String) -> Option<String> {
        let advice = (!self.advice.is_empty()).then(|| self.advice.to_owned())?;
        Some(self.instead.map_or(advice.clone(), |reference| format!("{advice}: {}.", option(reference))))
    }
}
