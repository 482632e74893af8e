//! What may not be written: stubs, the platform's float functions, paths of one machine.

use super::{Source, Violation, text};

/// Marks of unfinished work, in code and comments alike. Cut in two here so that this table is not found by its own rule.
const STUBS: [&str; 6] = [
    concat!("TO", "DO"),
    concat!("FIX", "ME"),
    concat!("XX", "X"),
    concat!("todo", "!"),
    concat!("unimpl", "emented!"),
    concat!("#[ign", "ore"),
];

/// Float methods of `std` or of the platform: not in `core`, or not the same bits everywhere, or a fused multiply-add.
const FLOAT_METHODS: [&str; 31] = [
    "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "ceil", "cos", "cosh", "exp", "exp2", "exp_m1",
    "floor", "fract", "hypot", "ln", "ln_1p", "log", "log10", "log2", "mul_add", "powf", "powi", "round", "sin",
    "sin_cos", "sqrt", "tan", "trunc",
];

/// The one place that may name a float method of the platform, and the method: a square root is correctly rounded everywhere.
const SQRT: (&str, &str) = ("controller/src/math.rs", "sqrt");

/// Folders that exist on somebody's machine only.
const MACHINE_FOLDERS: [&str; 4] = ["work", "root", "home", "Users"];

/// Work left undone.
#[must_use]
pub fn stubs(sources: &[Source]) -> Vec<Violation> {
    let written = sources
        .iter()
        .filter(|source| source.is_rust() || source.path == ".ci/run" || source.path.ends_with(".toml"));
    written
        .flat_map(|source| {
            let found = STUBS
                .iter()
                .flat_map(|stub| text::words(&source.text, stub).map(move |at| (stub, at)));
            found.map(|(stub, at)| {
                Violation::new(
                    source,
                    text::line_of(&source.text, at),
                    format!("`{stub}`: finish it, or leave it out"),
                )
            })
        })
        .collect()
}

/// Float methods that would make results differ between machines.
#[must_use]
pub fn float_methods(sources: &[Source]) -> Vec<Violation> {
    let exact = sources.iter().filter(|source| {
        source.is_rust() && (source.path.starts_with("controller/") || source.path.starts_with("shared/"))
    });
    exact
        .flat_map(|source| {
            let code = text::code(source.shipped());
            let named = FLOAT_METHODS
                .iter()
                .filter(|&&method| (source.path.as_str(), method) != SQRT);
            let forms = named.flat_map(|method| {
                [
                    format!(".{method}("),
                    format!("f32::{method}"),
                    format!("f64::{method}"),
                ]
            });
            let lines = forms.flat_map(|form| {
                text::words(&code, &form)
                    .map(|at| (text::line_of(&code, at), form.clone()))
                    .collect::<Vec<_>>()
            });
            lines
                .map(|(line, form)| {
                    Violation::new(
                        source,
                        line,
                        format!("`{form}` is the platform's: use math::sqrt or libm"),
                    )
                })
                .collect::<Vec<_>>()
        })
        .collect()
}

/// Absolute paths of one machine.
#[must_use]
pub fn machine_paths(sources: &[Source]) -> Vec<Violation> {
    sources
        .iter()
        .flat_map(|source| {
            let begins = |at: usize| !source.text[..at].ends_with(|c: char| text::is_word(c) || "./-*}".contains(c));
            let found = MACHINE_FOLDERS.iter().flat_map(move |folder| {
                let path = format!("/{folder}/");
                source
                    .text
                    .match_indices(&path)
                    .map(|(at, _)| at)
                    .filter(|&at| begins(at))
                    .map(|at| (at, path.clone()))
                    .collect::<Vec<_>>()
            });
            found.map(|(at, path)| {
                Violation::new(
                    source,
                    text::line_of(&source.text, at),
                    format!("`{path}…` is a folder of one machine: use a relative path"),
                )
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(path: &str, text: &str) -> Source {
        Source {
            path: path.into(),
            text: text.into(),
        }
    }

    #[test]
    fn a_stub_is_found_in_code_and_comment() {
        for stub in STUBS {
            assert_eq!(
                stubs(&[source("a.rs", &format!("fn a() {{}}\n// {stub} b"))]).len(),
                1,
                "{stub}"
            );
        }
        assert!(stubs(&[source("a.rs", "mktemp -t AXXXXB")]).is_empty());
    }

    #[test]
    fn a_float_method_is_found_where_bits_matter() {
        for line in ["x.sqrt()", "a.mul_add(b, c)", "f32::sin(x)", "v.map(f32::floor)"] {
            let text = format!("fn f() {{ {line} }}");
            assert_eq!(
                float_methods(&[source("controller/src/law.rs", &text)]).len(),
                1,
                "{line}"
            );
            assert_eq!(
                float_methods(&[source("shared/src/scene.rs", &text)]).len(),
                1,
                "{line}"
            );
            assert!(float_methods(&[source("host/src/lib.rs", &text)]).is_empty(), "{line}");
        }
        assert!(
            float_methods(&[source(
                "controller/src/law.rs",
                "// x.sqrt()\nlibm::sinf(x); sqrt(x); x.abs()"
            )])
            .is_empty()
        );
        assert!(float_methods(&[source(SQRT.0, "x.sqrt()")]).is_empty());
        assert!(float_methods(&[source("controller/src/law/tests.rs", "x.sqrt()")]).is_empty());
        assert_eq!(float_methods(&[source(SQRT.0, "x.exp()")]).len(), 1);
    }

    #[test]
    fn a_path_of_one_machine_is_found() {
        for folder in MACHINE_FOLDERS {
            assert_eq!(
                machine_paths(&[source("a.md", &format!("a\nsee (/{folder}/me)"))]).len(),
                1,
                "{folder}"
            );
            assert!(
                machine_paths(&[source("a.md", &format!("../{folder}/me host/{folder}/me"))]).is_empty(),
                "{folder}"
            );
        }
    }
}
