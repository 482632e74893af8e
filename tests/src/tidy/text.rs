//! Rust text taken apart just far enough for the rules: code without comments and literals, code without its tests.

/// `text` with every comment, string and character literal blanked out: same lines, same columns in bytes of code.
#[must_use]
pub fn code(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(next) = rest.chars().next() {
        let blank = match literal_len(rest, code.chars().next_back()) {
            0 => {
                code.push(next);
                next.len_utf8()
            }
            len => {
                code.extend(rest[..len].chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
                len
            }
        };
        rest = &rest[blank..];
    }
    code
}

/// Bytes of the comment or literal that `rest` begins with, after the character `before`; 0 if it begins with code.
fn literal_len(rest: &str, before: Option<char>) -> usize {
    if rest.starts_with("//") {
        rest.find('\n').unwrap_or(rest.len())
    } else if rest.starts_with("/*") {
        block_comment_len(rest)
    } else if let Some(inside) = rest.strip_prefix('"') {
        1 + escaped_len(inside, '"')
    } else if rest.starts_with('\'') {
        char_len(rest)
    } else if before.is_some_and(is_word) {
        0
    } else {
        raw_string_len(rest)
    }
}

fn block_comment_len(rest: &str) -> usize {
    let mut depth = 0_usize;
    let mut at = 0;
    while at < rest.len() {
        if rest[at..].starts_with("/*") {
            depth += 1;
            at += 2;
        } else if rest[at..].starts_with("*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                return at;
            }
        } else {
            at += rest[at..].chars().next().map_or(1, char::len_utf8);
        }
    }
    rest.len()
}

/// Bytes up to and with the first `quote` that no backslash escapes.
fn escaped_len(rest: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in rest.char_indices() {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if c == quote => return at + c.len_utf8(),
            _ => {}
        }
    }
    rest.len()
}

/// A character literal, or 0 for a lifetime.
fn char_len(rest: &str) -> usize {
    let mut inside = rest.chars().skip(1);
    match (inside.next(), inside.next()) {
        (Some('\\'), _) => 1 + escaped_len(&rest[1..], '\''),
        (Some(c), Some('\'')) => 2 + c.len_utf8(),
        _ => 0,
    }
}

/// A raw string such as `r#"…"#`, or 0.
fn raw_string_len(rest: &str) -> usize {
    let body = rest.strip_prefix('b').unwrap_or(rest);
    let Some(body) = body.strip_prefix('r') else { return 0 };
    let hashes = body.len() - body.trim_start_matches('#').len();
    let Some(inside) = body[hashes..].strip_prefix('"') else {
        return 0;
    };
    let end = format!("\"{}", "#".repeat(hashes));
    let opening = rest.len() - inside.len();
    inside.find(&end).map_or(rest.len(), |at| opening + at + end.len())
}

/// What stands before the file's unit tests.
#[must_use]
pub fn before_tests(text: &str) -> &str {
    let tests = if text.starts_with("#[cfg(test)]") {
        Some(0)
    } else {
        text.find("\n#[cfg(test)]\nmod ")
    };
    &text[..tests.map_or(text.len(), |at| at + usize::from(at > 0))]
}

/// Whether a name may contain the character.
#[must_use]
pub fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Line of the byte `at`, from 1.
#[must_use]
pub fn line_of(text: &str, at: usize) -> usize {
    1 + text[..at].matches('\n').count()
}

/// Where `word` stands by itself in `text`: no letter, digit or underscore on the sides where it has one itself.
pub fn words<'t>(text: &'t str, word: &'t str) -> impl Iterator<Item = usize> + 't {
    let open = |end: Option<char>, beyond: Option<char>| !(end.is_some_and(is_word) && beyond.is_some_and(is_word));
    text.match_indices(word).map(|(at, _)| at).filter(move |&at| {
        open(word.chars().next(), text[..at].chars().next_back())
            && open(word.chars().next_back(), text[at + word.len()..].chars().next())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_literals_are_blanked() {
        let text = "a /* x /* y */ z */ b // c\n\"d\\\"e\" f 'g' '\\'' h<'i> br#\"j\"k\"# l";
        let words: Vec<_> = code(text).split_whitespace().map(str::to_owned).collect();
        assert_eq!(words, ["a", "b", "f", "h<'i>", "l"]);
    }

    #[test]
    fn lines_stay_where_they_are() {
        let text = "/* one\ntwo */ three // four\nfive";
        assert_eq!(code(text).lines().count(), 3);
        assert!(code(text).lines().nth(1).is_some_and(|line| line.trim() == "three"));
    }

    #[test]
    fn tests_are_cut_off() {
        assert_eq!(before_tests("a\n#[cfg(test)]\nmod tests {}\n"), "a\n");
        assert_eq!(
            before_tests("a\n#[cfg(test)]\nfn shown() {}\n"),
            "a\n#[cfg(test)]\nfn shown() {}\n"
        );
    }

    #[test]
    fn a_word_stands_alone() {
        assert_eq!(words("fn fnord fn", "fn").collect::<Vec<_>>(), [0, 9]);
        assert_eq!(words("a.exp() b.expm()", ".exp(").collect::<Vec<_>>(), [1]);
    }
}
