//! The grammar: statements and expressions to raw trees, names still words. Answers function-files.md section 2.
//!
//! Sums and products are lists rather than left-deep trees, so that the depth of a tree is bounded by the nesting of its
//! text, whatever its length.

use crate::error::Problem;
use crate::lex::{Parsed, Text, blanks, channel, expect, fail, name, number, starts_name};

/// Parentheses, calls and powers may nest this deep. Real files stay below 40; the bound keeps hostile ones from
/// exhausting the stack of whoever walks the tree.
pub(crate) const NESTING: u32 = 200;

/// What the host program allows in a text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grammar {
    /// `$n` may be read.
    pub(crate) channels: bool,
    /// `$n = …` may be defined.
    pub(crate) outputs: bool,
    /// Names may stand for values; otherwise every name is a call.
    pub(crate) variables: bool,
}

/// A tree as written, with the place just after it for messages.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Raw {
    pub(crate) node: Node,
    /// Bytes of text left after the tree and the blanks behind it.
    pub(crate) left: usize,
}

/// The kinds of raw tree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Node {
    Number(f64),
    Channel(u32),
    Name(String),
    Call(String, Vec<Raw>),
    Negative(Box<Raw>),
    /// First term, then (subtracted, term) from left to right.
    Sum(Box<Raw>, Vec<(bool, Raw)>),
    /// First factor, then (divided by, factor) from left to right.
    Product(Box<Raw>, Vec<(bool, Raw)>),
    Power(Box<(Raw, Raw)>),
}

/// What a statement defines.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Target {
    Variable(String),
    Function(String, Vec<String>),
    Output(u32),
}

/// One definition.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Statement {
    pub(crate) target: Target,
    /// Defined with `:` rather than `=`.
    pub(crate) constant: bool,
    pub(crate) body: Raw,
}

impl Grammar {
    /// The next statement of a file and what follows it; `None` at the end of the text.
    pub(crate) fn statement(self, text: Text<'_>) -> Parsed<'_, Option<Statement>> {
        let (mut text, ()) = blanks(text)?;
        while text.first() == Some(&b';') {
            (text, ()) = blanks(&text[1..])?;
        }
        if text.is_empty() {
            return Ok((text, None));
        }
        let (rest, (target, constant)) = self.head(text)?;
        let (rest, body) = self.sum(rest, 0)?;
        let rest = if rest.is_empty() { rest } else { expect(rest, b';', "';'")?.0 };
        Ok((rest, Some(Statement { target, constant, body })))
    }

    /// One whole expression and nothing else.
    pub(crate) fn expression(self, text: Text<'_>) -> Parsed<'_, Raw> {
        let (rest, ()) = blanks(text)?;
        let (rest, tree) = self.sum(rest, 0)?;
        if rest.is_empty() { Ok((rest, tree)) } else { fail(rest, Problem::UnexpectedCharacter) }
    }

    fn head(self, text: Text<'_>) -> Parsed<'_, (Target, bool)> {
        if self.outputs && text.first() == Some(&b'$') {
            let (rest, number) = channel(&text[1..])?;
            let (rest, ()) = expect(rest, b'=', "'='")?;
            return Ok((rest, (Target::Output(number), false)));
        }
        if !starts_name(text) {
            return fail(text, Problem::IllegalVariableName);
        }
        let (rest, word) = name(text)?;
        let (rest, target) = if rest.first() == Some(&b'(') {
            let (rest, parameters) = parameters(rest)?;
            (rest, Target::Function(word, parameters))
        } else {
            (rest, Target::Variable(word))
        };
        let constant = match rest.first() {
            Some(b'=') => false,
            Some(b':') => true,
            _ => return fail(rest, Problem::Expected("'=' or ':'")),
        };
        let (rest, ()) = blanks(&rest[1..])?;
        Ok((rest, (target, constant)))
    }

    fn sum(self, text: Text<'_>, depth: u32) -> Parsed<'_, Raw> {
        let (mut rest, first) = self.product(text, depth)?;
        let mut more = Vec::new();
        while let Some(sign @ (b'+' | b'-')) = rest.first() {
            let (after, ()) = blanks(&rest[1..])?;
            let (after, term) = self.product(after, depth)?;
            more.push((*sign == b'-', term));
            rest = after;
        }
        Ok((rest, chain(first, more, Node::Sum, rest)))
    }

    fn product(self, text: Text<'_>, depth: u32) -> Parsed<'_, Raw> {
        let (mut rest, first) = self.power(text, depth)?;
        let mut more = Vec::new();
        while let Some(sign @ (b'*' | b'/')) = rest.first() {
            let (after, ()) = blanks(&rest[1..])?;
            let (after, factor) = self.power(after, depth)?;
            more.push((*sign == b'/', factor));
            rest = after;
        }
        Ok((rest, chain(first, more, Node::Product, rest)))
    }

    fn power(self, text: Text<'_>, depth: u32) -> Parsed<'_, Raw> {
        if depth > NESTING {
            return fail(text, Problem::TooDeep(NESTING));
        }
        let (rest, base) = self.unary(text, depth)?;
        if rest.first() != Some(&b'^') {
            return Ok((rest, base));
        }
        let (rest, ()) = blanks(&rest[1..])?;
        let (rest, exponent) = self.power(rest, depth + 1)?;
        Ok((rest, Raw { node: Node::Power(Box::new((base, exponent))), left: rest.len() }))
    }

    fn unary(self, text: Text<'_>, depth: u32) -> Parsed<'_, Raw> {
        let Some(sign @ (b'+' | b'-')) = text.first() else { return self.primary(text, depth) };
        let (rest, ()) = blanks(&text[1..])?;
        let (rest, value) = self.primary(rest, depth)?;
        let left = value.left;
        Ok((rest, if *sign == b'-' { Raw { node: Node::Negative(Box::new(value)), left } } else { value }))
    }

    fn primary(self, text: Text<'_>, depth: u32) -> Parsed<'_, Raw> {
        let (rest, node) = match text.first() {
            Some(b'(') => {
                let (rest, ()) = blanks(&text[1..])?;
                let (rest, inner) = self.sum(rest, depth + 1)?;
                let (rest, ()) = expect(rest, b')', "')'")?;
                (rest, inner.node)
            }
            Some(b'$') if self.channels => {
                let (rest, index) = channel(&text[1..])?;
                (rest, Node::Channel(index))
            }
            Some(b'0'..=b'9' | b'.') => {
                let (rest, value) = number(text)?;
                (rest, Node::Number(value))
            }
            _ if starts_name(text) => {
                let (rest, word) = name(text)?;
                if rest.first() == Some(&b'(') {
                    let (rest, arguments) = self.arguments(rest, depth)?;
                    (rest, Node::Call(word, arguments))
                } else if self.variables {
                    (rest, Node::Name(word))
                } else {
                    return fail(rest, Problem::Expected("'('"));
                }
            }
            _ => return fail(text, Problem::UnexpectedCharacter),
        };
        Ok((rest, Raw { node, left: rest.len() }))
    }

    fn arguments(self, text: Text<'_>, depth: u32) -> Parsed<'_, Vec<Raw>> {
        let mut rest = text;
        let mut list = Vec::new();
        while list.is_empty() || rest.first() == Some(&b',') {
            let (after, ()) = blanks(&rest[1..])?;
            let (after, argument) = self.sum(after, depth + 1)?;
            list.push(argument);
            rest = after;
        }
        let (rest, ()) = expect(rest, b')', "')'")?;
        Ok((rest, list))
    }
}

/// The parameter list of a function's definition, from its parenthesis.
fn parameters(text: Text<'_>) -> Parsed<'_, Vec<String>> {
    let mut rest = text;
    let mut list = Vec::new();
    while list.is_empty() || rest.first() == Some(&b',') {
        let (after, ()) = blanks(&rest[1..])?;
        if !starts_name(after) {
            return fail(after, Problem::IllegalParameterName);
        }
        let (end, word) = name(after)?;
        if word.contains('`') {
            return fail(end, Problem::IllegalParameterName);
        }
        list.push(word);
        rest = end;
    }
    let (rest, ()) = expect(rest, b')', "')'")?;
    Ok((rest, list))
}

fn chain(first: Raw, more: Vec<(bool, Raw)>, wrap: fn(Box<Raw>, Vec<(bool, Raw)>) -> Node, rest: Text<'_>) -> Raw {
    if more.is_empty() { first } else { Raw { node: wrap(Box::new(first), more), left: rest.len() } }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FULL: Grammar = Grammar { channels: true, outputs: true, variables: true };

    fn why(text: &str) -> String {
        match FULL.statement(text.as_bytes()) {
            Err(nom::Err::Failure(trouble)) => format!("{} {}", text.len() - trouble.left, trouble.problem),
            other => panic!("{text}: {other:?}"),
        }
    }

    #[test]
    fn statements_are_read_one_by_one() {
        let (rest, first) = FULL.statement(b";; f ( a , b ) : a+b ; $2 = 3").unwrap();
        let first = first.unwrap();
        assert_eq!(first.target, Target::Function("f".into(), vec!["a".into(), "b".into()]));
        assert!(first.constant);
        let (rest, second) = FULL.statement(rest).unwrap();
        assert_eq!(second.unwrap().target, Target::Output(2));
        assert_eq!(FULL.statement(rest).unwrap().1, None);
    }

    #[test]
    fn errors_name_what_is_missing_and_stand_where_radiance_puts_them() {
        assert_eq!(why("a"), "1 '=' or ':' expected");
        assert_eq!(why("a+b"), "1 '=' or ':' expected");
        assert_eq!(why("$1 : 3"), "3 '=' expected");
        assert_eq!(why("3=4"), "0 illegal variable name");
        assert_eq!(why("_a=3"), "0 illegal variable name");
        assert_eq!(why("f()=1"), "2 illegal parameter name");
        assert_eq!(why("f(a`b)=1"), "5 illegal parameter name");
        assert_eq!(why("$1=2.5.5"), "6 ';' expected");
        assert_eq!(why("$1=x(1)(2)"), "7 ';' expected");
        assert_eq!(why("$1=--3"), "4 unexpected character");
        assert_eq!(why("$1=f()"), "5 unexpected character");
        assert_eq!(why("\u{feff}a=1"), "0 illegal variable name");
    }

    #[test]
    fn nesting_is_bounded_and_length_is_not() {
        let deep = format!("x={}1{}", "(".repeat(1000), ")".repeat(1000));
        assert!(why(&deep).ends_with("nested deeper than 200 levels"));
        assert!(why(&format!("x=1{}", "^1".repeat(1000))).contains("nested deeper"));
        let fine = format!("x={}1{}", "(".repeat(190), ")".repeat(190));
        assert!(FULL.statement(fine.as_bytes()).is_ok());
        let long = format!("x=1{}", "+1/2".repeat(100_000));
        assert!(FULL.statement(long.as_bytes()).is_ok());
    }
}
