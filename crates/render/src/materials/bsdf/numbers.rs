//! Lists of numbers between blanks, commas and braces.

/// Reads numbers and single characters off a text.
pub(super) struct Numbers<'t> {
    text: &'t [u8],
    next: usize,
}

fn is_blank(c: u8) -> bool {
    c.is_ascii_whitespace() || c == b','
}

impl<'t> Numbers<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self { text: text.as_bytes(), next: 0 }
    }

    /// Bytes read so far.
    pub(super) fn offset(&self) -> usize {
        self.next
    }

    /// The next character that is not blank; None at the end.
    pub(super) fn peek(&mut self) -> Option<u8> {
        while self.next < self.text.len() && is_blank(self.text[self.next]) {
            self.next += 1;
        }
        self.text.get(self.next).copied()
    }

    /// Reads this character if it comes next.
    pub(super) fn take(&mut self, c: u8) -> bool {
        let here = self.peek() == Some(c);
        self.next += usize::from(here);
        here
    }

    /// Reads a finite number; negative ones, which measurements give for nothing, become 0.
    pub(super) fn next_number(&mut self) -> Option<f32> {
        self.peek()?;
        let rest = &self.text[self.next..];
        let ends = |c: &u8| is_blank(*c) || *c == b'{' || *c == b'}';
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        // `inf` and `nan`, which the standard parser knows, are no numbers here.
        let value: f32 = std::str::from_utf8(&rest[..length]).ok()?.parse().ok()?;
        if !value.is_finite() {
            return None;
        }
        self.next += length;
        Some(value.max(0.0))
    }
}
