//! From Young's modulus to springs: the law, how voxels share an edge, and the names of both.

use crate::check::{Invalid, Validate, require};
use core::fmt;
use core::str::FromStr;
use serde::{Deserialize, Serialize};

/// From Young's modulus E and voxel edge a to the stiffness of edges k_n and body diagonals k_d.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Law {
    /// k_n = 0.8 E a, k_d = 0.3 E a: isotropic, Poisson's ratio 1/4, E exact in every direction.
    Isotropic,
    /// k_n = √(2/3) E a, k_d = 0.25 E a: E along the axes and G = E/3 exact.
    Axial,
    /// k_n = 0.45 E a, k_d = 0.25 E a as printed by Lian & Chen (Eqs 5, 6).
    Paper,
    /// k_n = 2 G a, k_d = 0.75 G a with G = E/(2(1 + ν)), and for each voxel the energy ½ Λ (J − 1)² a³ with
    /// Λ = G (4ν − 1)/(1 − 2ν): isotropic, E and ν exact. Below J = 0.3 a barrier keeps voxels from inverting.
    Volume {
        /// Poisson's ratio ν; within [`POISSON`].
        poisson: f32,
    },
}

/// Least and greatest Poisson's ratio of [`Law::Volume`]: from where Λ is zero to short of where it has no bound.
pub const POISSON: [f32; 2] = [0.25, 0.49];
/// Poisson's ratio of [`Law::Volume`] where none is named: soft tissue keeps its volume nearly.
const POISSON_DEFAULT: f32 = 0.45;

impl Law {
    /// The law of this name; `poisson` belongs to `volume` alone, where 0.45 stands for none.
    ///
    /// # Errors
    /// See [`NoLaw`].
    pub fn named(name: &str, poisson: Option<f32>) -> Result<Self, NoLaw> {
        let law = match name {
            "isotropic" => Self::Isotropic,
            "axial" => Self::Axial,
            "paper" => Self::Paper,
            "volume" => Self::Volume {
                poisson: poisson.unwrap_or(POISSON_DEFAULT),
            },
            _ => return Err(NoLaw::Name),
        };
        match (law, poisson) {
            (Self::Volume { .. }, _) | (_, None) => law.validate().map(|()| law).map_err(|_| NoLaw::Range),
            _ => Err(NoLaw::Fixed),
        }
    }

    /// The name in scene files and commands.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Isotropic => "isotropic",
            Self::Axial => "axial",
            Self::Paper => "paper",
            Self::Volume { .. } => "volume",
        }
    }
}

impl Validate for Law {
    fn validate(&self) -> Result<(), Invalid> {
        let [least, most] = POISSON;
        match self {
            Self::Volume { poisson } => {
                require((least..=most).contains(poisson), "lattice.law.poisson", "0.25 to 0.49")
            }
            Self::Isotropic | Self::Axial | Self::Paper => Ok(()),
        }
    }
}

/// Why there is no such law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoLaw {
    /// No law has this name.
    Name,
    /// A Poisson's ratio beside a law that has its own.
    Fixed,
    /// A Poisson's ratio out of [`POISSON`].
    Range,
}

impl fmt::Display for NoLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Name => "there are isotropic, axial, paper, volume",
            Self::Fixed => "Poisson's ratio is free with law volume only; the other laws have their own",
            Self::Range => "Poisson's ratio is 0.25 to 0.49",
        })
    }
}

impl core::error::Error for NoLaw {}

/// What voxels that share an edge give it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Assembly {
    /// k_n/4 each: every block has the moduli of the bulk.
    #[default]
    PerVoxel,
    /// k_n together, their mean where they differ: one spring a distinct edge, which makes small blocks too stiff.
    EveryEdge,
}

impl Assembly {
    /// The name in scene files and commands.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PerVoxel => "per-voxel",
            Self::EveryEdge => "every-edge",
        }
    }
}

impl FromStr for Assembly {
    type Err = NoAssembly;

    fn from_str(text: &str) -> Result<Self, NoAssembly> {
        let all = [Self::PerVoxel, Self::EveryEdge];
        all.into_iter().find(|it| it.name() == text).ok_or(NoAssembly)
    }
}

/// There is no such assembly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoAssembly;

impl fmt::Display for NoAssembly {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("there are per-voxel, every-edge")
    }
}

impl core::error::Error for NoAssembly {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laws_and_assemblies_are_found_by_their_names() {
        let volume = Law::Volume { poisson: 0.4 };
        for (law, poisson) in [
            (Law::Isotropic, None),
            (Law::Axial, None),
            (Law::Paper, None),
            (volume, Some(0.4)),
        ] {
            assert_eq!(Law::named(law.name(), poisson), Ok(law));
        }
        assert_eq!(Law::named("volume", None), Ok(Law::Volume { poisson: 0.45 }));
        for assembly in [Assembly::PerVoxel, Assembly::EveryEdge] {
            assert_eq!(assembly.name().parse(), Ok(assembly));
        }
        assert_eq!("each".parse::<Assembly>(), Err(NoAssembly));
    }

    #[test]
    fn a_ratio_that_a_law_cannot_have_is_refused() {
        assert_eq!(Law::named("hooke", None), Err(NoLaw::Name));
        assert_eq!(Law::named("axial", Some(0.3)), Err(NoLaw::Fixed));
        for poisson in [0.2, 0.5, f32::NAN] {
            assert_eq!(Law::named("volume", Some(poisson)), Err(NoLaw::Range));
        }
    }
}
