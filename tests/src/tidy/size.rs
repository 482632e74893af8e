//! Length of files and functions.

use super::{Source, Violation, text};

/// Most lines of a file before its unit tests.
pub const FILE_LINES: usize = 400;
/// Most lines of a function, from its `fn` to its closing brace.
pub const FUNCTION_LINES: usize = 60;

/// Files that are too long.
#[must_use]
pub fn files(sources: &[Source]) -> Vec<Violation> {
    let rust = sources.iter().filter(|source| source.is_rust());
    rust.filter_map(|source| {
        let lines = text::before_tests(&source.text).lines().count();
        let what = || format!("{lines} lines before the tests, at most {FILE_LINES}: split it by reason to change");
        (lines > FILE_LINES).then(|| Violation::new(source, 0, what()))
    })
    .collect()
}

/// Functions that are too long.
#[must_use]
pub fn functions(sources: &[Source]) -> Vec<Violation> {
    let rust = sources.iter().filter(|source| source.is_rust());
    rust.flat_map(|source| {
        let code = text::code(&source.text);
        let long: Vec<_> = bodies(&code).filter(|&(_, lines)| lines > FUNCTION_LINES).collect();
        long.into_iter().map(|(line, lines)| {
            let what = format!("a function of {lines} lines, at most {FUNCTION_LINES}: split it by step");
            Violation::new(source, line, what)
        })
    })
    .collect()
}

/// Line of the `fn` and number of lines of every function with a body.
fn bodies(code: &str) -> impl Iterator<Item = (usize, usize)> {
    text::words(code, "fn").filter_map(|at| {
        let end = at + body_end(&code[at..])?;
        Some((text::line_of(code, at), 1 + code[at..end].matches('\n').count()))
    })
}

/// Where the body of the function that `code` begins with ends, if it has one.
fn body_end(code: &str) -> Option<usize> {
    // `fn(` is a type.
    if !code["fn".len()..].starts_with(|c: char| c.is_whitespace()) {
        return None;
    }
    let mut brackets = 0_i32;
    let mut braces = 0_i32;
    for (at, c) in code.char_indices() {
        match c {
            '(' | '[' => brackets += 1,
            ')' | ']' => brackets -= 1,
            ';' if brackets == 0 && braces == 0 => return None,
            '{' if brackets == 0 || braces > 0 => braces += 1,
            '}' if braces > 0 => {
                braces -= 1;
                if braces == 0 {
                    return Some(at);
                }
            }
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: String) -> Source {
        Source {
            path: "a.rs".into(),
            text,
        }
    }

    #[test]
    fn a_long_file_is_found_and_its_tests_do_not_count() {
        let line = "const A: u8 = 0;\n";
        let tests = format!("#[cfg(test)]\nmod tests {{\n{}}}\n", line.repeat(9));
        assert!(files(&[source(line.repeat(FILE_LINES) + &tests)]).is_empty());
        assert_eq!(files(&[source(line.repeat(FILE_LINES + 1))]).len(), 1);
    }

    #[test]
    fn a_long_function_is_found_wherever_it_stands() {
        let function = |inner| {
            format!(
                "trait T {{\n    fn none(a: [u8; {{ 3 }}]);\n    fn some() {{\n{}    }}\n}}\n",
                "        {}\n".repeat(inner)
            )
        };
        assert!(functions(&[source(function(FUNCTION_LINES - 2))]).is_empty());
        let found = functions(&[source(function(FUNCTION_LINES - 1))]);
        assert_eq!(found.iter().map(|violation| violation.line).collect::<Vec<_>>(), [3]);
    }

    #[test]
    fn a_brace_in_a_string_is_no_brace() {
        let text = format!("fn a() {{\n    b(\"}}\");\n{}}}\n", "    c();\n".repeat(FUNCTION_LINES));
        assert_eq!(functions(&[source(text)]).len(), 1);
    }
}
