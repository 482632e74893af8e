//! Sutures by material and USP size.

use std::f64::consts::PI;

/// What a thread is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Its name.
    pub name: &'static str,
    /// Young's modulus [GPa].
    pub young_gpa: f64,
    /// Density [kg/m³].
    pub density_kg_m3: f64,
    /// How many times easier it bends than a solid thread.
    pub limp: f64,
}

/// The materials that a scene may name. Moduli: nylon 6/66 has 1.8 to 2.5 GPa; silk's initial one is that of Naleway et al. 2015, for the
/// braid; polypropylene's that of Nindhia et al. 2021. A braid bends 10 to 100 times as easily as a solid thread; 30 is our choice.
pub const MATERIALS: [Material; 3] = [
    material("nylon", 2.0, 1140.0, 1.0),
    material("silk", 8.701, 1340.0, 30.0),
    material("polypropylene", 4.03, 905.0, 1.0),
];

const fn material(name: &'static str, young_gpa: f64, density_kg_m3: f64, limp: f64) -> Material {
    Material {
        name,
        young_gpa,
        density_kg_m3,
        limp,
    }
}

/// USP sizes of threads that are not absorbed, with a usual diameter of each [mm].
pub const SIZES: [(&str, f64); 7] = [
    ("6-0", 0.08),
    ("5-0", 0.12),
    ("4-0", 0.17),
    ("3-0", 0.22),
    ("2-0", 0.32),
    ("0", 0.37),
    ("1", 0.45),
];

/// What a scene needs to know of a thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suture {
    /// Axial stiffness EA [N].
    pub axial_n: f64,
    /// Mass per length [mg/m].
    pub mass_mg_per_m: f64,
    /// Bending stiffness EI [nN·m²].
    pub bending_nn_m2: f64,
}

/// The suture called `name`: a material and a size, as in `nylon 3-0`.
#[must_use]
pub fn named(name: &str) -> Option<Suture> {
    let (material, size) = name.split_once(' ')?;
    let material = MATERIALS.iter().find(|known| known.name == material)?;
    let (_, diameter_mm) = SIZES.iter().find(|(known, _)| *known == size)?;
    let section_mm2 = PI / 4.0 * diameter_mm * diameter_mm;
    Some(Suture {
        axial_n: material.young_gpa * 1e3 * section_mm2,
        mass_mg_per_m: material.density_kg_m3 * section_mm2,
        // E·π d⁴/64; a GPa·mm⁴ is 10⁶ nN·m².
        bending_nn_m2: material.young_gpa * PI / 64.0 * diameter_mm.powi(4) * 1e6 / material.limp,
    })
}

/// The names that there are, in words.
#[must_use]
pub fn names() -> String {
    let materials = MATERIALS.map(|material| material.name).join(", ");
    let sizes = SIZES.map(|(size, _)| size).join(", ");
    format!("a material ({materials}) and a USP size ({sizes}), such as \"nylon 3-0\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// EA [N], mass per length [mg/m] and EI [nN·m²] of four sutures as computed from diameters of 0.22 and 0.17 mm, densities of 1140, 1340 and
    /// 905 kg/m³ and moduli of 2.0, 8.7 and 4.0 GPa; solid silk would have 1000 nN·m².
    #[test]
    fn stiffness_and_mass_are_those_of_material_and_size() {
        for (name, axial_n, mass_mg_per_m, bending_nn_m2) in [
            ("nylon 3-0", 76.0, 43.0, 230.0),
            ("silk 3-0", 331.0, 51.0, 1000.0 / 30.0),
            ("polypropylene 3-0", 152.0, 34.0, 460.0),
            ("nylon 4-0", 45.0, 26.0, 82.0),
        ] {
            let suture = named(name).unwrap();
            for (value, expected) in [
                (suture.axial_n, axial_n),
                (suture.mass_mg_per_m, mass_mg_per_m),
                (suture.bending_nn_m2, bending_nn_m2),
            ] {
                assert!((value / expected - 1.0).abs() < 0.025, "{name}: {suture:?}");
            }
        }
    }

    /// The least and greatest diameters that the USP allows [mm].
    #[test]
    fn diameters_are_within_their_sizes() {
        let usp = [
            ("6-0", 0.070, 0.099),
            ("5-0", 0.100, 0.149),
            ("4-0", 0.150, 0.199),
            ("3-0", 0.200, 0.249),
            ("2-0", 0.300, 0.339),
            ("0", 0.350, 0.399),
            ("1", 0.400, 0.499),
        ];
        for ((name, diameter), (size, least, most)) in SIZES.into_iter().zip(usp) {
            assert_eq!(name, size);
            assert!((least..=most).contains(&diameter), "{name}");
        }
    }

    #[test]
    fn other_names_are_none() {
        for name in ["nylon", "nylon 7-0", "steel 3-0", "nylon  3-0", ""] {
            assert_eq!(named(name), None, "{name}");
        }
    }
}
