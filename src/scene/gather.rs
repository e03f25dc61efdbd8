//! Checks that go on after a mistake, so that all mistakes are told at once.

use crate::error::{Error, Result};

/// Several checks of which each is made, whatever the others find.
pub(super) trait Gather {
    type All;
    /// All that was checked, or the mistakes of all checks.
    fn gather(self) -> Result<Self::All>;
}

impl<A, B> Gather for (Result<A>, Result<B>) {
    type All = (A, B);
    fn gather(self) -> Result<(A, B)> {
        match self {
            (Ok(a), Ok(b)) => Ok((a, b)),
            (Err(error), Ok(_)) | (Ok(_), Err(error)) => Err(error),
            (Err(first), Err(second)) => Err(first.and(second)),
        }
    }
}

impl<A, B, C> Gather for (Result<A>, Result<B>, Result<C>) {
    type All = (A, B, C);
    fn gather(self) -> Result<(A, B, C)> {
        let ((a, b), c) = ((self.0, self.1).gather(), self.2).gather()?;
        Ok((a, b, c))
    }
}

impl<A, B, C, D> Gather for (Result<A>, Result<B>, Result<C>, Result<D>) {
    type All = (A, B, C, D);
    fn gather(self) -> Result<(A, B, C, D)> {
        let ((a, b), (c, d)) = ((self.0, self.1).gather(), (self.2, self.3).gather()).gather()?;
        Ok((a, b, c, d))
    }
}

/// The same of a list.
pub(super) fn all<T>(checks: impl IntoIterator<Item = Result<T>>) -> Result<Vec<T>> {
    let (mut checked, mut mistakes) = (Vec::new(), None::<Error>);
    for check in checks {
        match check {
            Ok(value) => checked.push(value),
            Err(error) => {
                mistakes = Some(match mistakes.take() {
                    Some(before) => before.and(error),
                    None => error,
                });
            }
        }
    }
    mistakes.map_or(Ok(checked), Err)
}

/// The failure of what cannot be checked because of a mistake that is told where it stands.
pub(super) fn told_elsewhere<T>() -> Result<T> {
    Err(Error::Scene(Vec::new()))
}
