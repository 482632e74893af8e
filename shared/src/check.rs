//! What a decoded value must hold to: floats finite and in range, indices in bounds.

/// Which value is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Invalid {
    /// Path of the value inside the message or scene, as in `lattice.pitch_m`.
    pub field: &'static str,
    /// What would be right, as in `1e-4 to 0.05`.
    pub expected: &'static str,
}

/// A value that can be well encoded and still make no sense.
pub trait Validate {
    /// Checks every float and every index.
    ///
    /// # Errors
    /// The first value that is not finite, out of range or at odds with another.
    fn validate(&self) -> Result<(), Invalid>;
}

/// Passes if `holds`.
///
/// # Errors
/// [`Invalid`] with `field` and `expected`.
pub const fn require(holds: bool, field: &'static str, expected: &'static str) -> Result<(), Invalid> {
    if holds {
        Ok(())
    } else {
        Err(Invalid { field, expected })
    }
}

/// Passes if every value is a finite number.
///
/// # Errors
/// [`Invalid`] with `field`.
pub fn finite(values: &[f32], field: &'static str) -> Result<(), Invalid> {
    require(values.iter().all(|value| value.is_finite()), field, "a finite number")
}

impl Validate for () {
    fn validate(&self) -> Result<(), Invalid> {
        Ok(())
    }
}
