//! A plain font of our own, on a grid of 5 by 7, for scenes that name a font of Radiance's library where there is no
//! such library. Letters differ from those fonts in shape, not in what they say.

use std::fmt::Write;

/// Fonts that this one may stand in for.
const KNOWN: [&str; 8] = [
    "Pix.fnt",
    "PixOblique.fnt",
    "Verdana.fnt",
    "VerdanaBold.fnt",
    "VerdanaBoldItalic.fnt",
    "VerdanaItalic.fnt",
    "helvet.fnt",
    "hexbit4x1.fnt",
];

const COLUMNS: usize = 5;
/// Units from one column to the next; the five stand in the middle of the square.
const COLUMN: usize = 42;
const LEFT: usize = 22;
/// Units from one row to the next, and to the lowest.
const ROW: usize = 30;
const BOTTOM: usize = 30;

/// The text of a font file that can stand in for `name`.
pub(crate) fn substitute(name: &str) -> Option<String> {
    KNOWN.contains(&name).then(font_file)
}

fn font_file() -> String {
    let mut text = String::from("32 0\n");
    for (code, rows) in (FIRST..).zip(ROWS) {
        let corners = outline(rows);
        let _ = write!(text, "{code} {}", corners.len());
        for (x, y) in corners {
            let _ = write!(text, " {x} {y}");
        }
        text.push('\n');
    }
    text
}

/// One closed line around all dark cells: from the lower left corner of the square to a block of cells, around it and
/// back, block by block. The ways there and back cancel in the even–odd rule.
fn outline(rows: &[u8]) -> Vec<(usize, usize)> {
    let mut dark: Vec<Vec<bool>> =
        rows.split(|&b| b == b' ').map(|row| row.iter().map(|&b| b == b'1').collect()).collect();
    let height = dark.len();
    let mut corners = vec![(0, 0)];
    for row in 0..height {
        for column in 0..COLUMNS {
            if !dark[row][column] {
                continue;
            }
            let length = dark[row][column..].iter().take_while(|&&d| d).count();
            let block = column..column + length;
            let same = |r: &Vec<bool>| {
                r[block.clone()].iter().all(|&d| d)
                    && (block.start == 0 || !r[block.start - 1])
                    && r.get(block.end).is_none_or(|&d| !d)
            };
            let rows_down = dark[row..].iter().take_while(|r| same(r)).count();
            for r in &mut dark[row..row + rows_down] {
                r[block.clone()].fill(false);
            }
            let (x0, x1) = (LEFT + COLUMN * block.start, LEFT + COLUMN * block.end);
            let (y0, y1) = (BOTTOM + ROW * (height - row - rows_down), BOTTOM + ROW * (height - row));
            corners.extend([(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0), (0, 0)]);
        }
    }
    corners
}

/// Code of the first glyph.
const FIRST: u8 = b'!';

/// The glyphs from `!` to `~`, rows from the top.
const ROWS: [&[u8]; 94] = [
    b"00100 00100 00100 00100 00100 00000 00100", // !
    b"01010 01010 01010 00000 00000 00000 00000", // "
    b"01010 01010 11111 01010 11111 01010 01010", // #
    b"00100 01111 10100 01110 00101 11110 00100", // $
    b"11001 11001 00010 00100 01000 10011 10011", // %
    b"01100 10010 10100 01000 10101 10010 01101", // &
    b"00100 00100 01000 00000 00000 00000 00000", // '
    b"00010 00100 01000 01000 01000 00100 00010", // (
    b"01000 00100 00010 00010 00010 00100 01000", // )
    b"00000 00100 10101 01110 10101 00100 00000", // *
    b"00000 00100 00100 11111 00100 00100 00000", // +
    b"00000 00000 00000 00000 01100 00100 01000", // ,
    b"00000 00000 00000 11111 00000 00000 00000", // -
    b"00000 00000 00000 00000 00000 01100 01100", // .
    b"00001 00001 00010 00100 01000 10000 10000", // /
    b"01110 10001 10001 10101 10001 10001 01110", // 0
    b"00100 01100 00100 00100 00100 00100 01110", // 1
    b"01110 10001 00001 00110 01000 10000 11111", // 2
    b"11111 00010 00100 00110 00001 10001 01110", // 3
    b"00010 00110 01010 10010 11111 00010 00010", // 4
    b"11111 10000 11110 00001 00001 10001 01110", // 5
    b"00110 01000 10000 11110 10001 10001 01110", // 6
    b"11111 00001 00010 00010 00100 00100 00100", // 7
    b"01110 10001 10001 01110 10001 10001 01110", // 8
    b"01110 10001 10001 01111 00001 00010 01100", // 9
    b"00000 01100 01100 00000 01100 01100 00000", // :
    b"00000 01100 01100 00000 01100 00100 01000", // ;
    b"00010 00100 01000 10000 01000 00100 00010", // <
    b"00000 00000 11111 00000 11111 00000 00000", // =
    b"01000 00100 00010 00001 00010 00100 01000", // >
    b"01110 10001 00001 00110 00100 00000 00100", // ?
    b"01110 10001 10111 10101 10111 10000 01111", // @
    b"00100 01010 10001 10001 11111 10001 10001", // A
    b"11110 10001 10001 11110 10001 10001 11110", // B
    b"01110 10001 10000 10000 10000 10001 01110", // C
    b"11100 10010 10001 10001 10001 10010 11100", // D
    b"11111 10000 10000 11110 10000 10000 11111", // E
    b"11111 10000 10000 11110 10000 10000 10000", // F
    b"01110 10001 10000 10111 10001 10001 01110", // G
    b"10001 10001 10001 11111 10001 10001 10001", // H
    b"01110 00100 00100 00100 00100 00100 01110", // I
    b"00111 00010 00010 00010 00010 10010 01100", // J
    b"10001 10010 10100 11000 10100 10010 10001", // K
    b"10000 10000 10000 10000 10000 10000 11111", // L
    b"10001 11011 10101 10101 10001 10001 10001", // M
    b"10001 11001 11001 10101 10011 10011 10001", // N
    b"01110 10001 10001 10001 10001 10001 01110", // O
    b"11110 10001 10001 11110 10000 10000 10000", // P
    b"01110 10001 10001 10001 10101 10010 01101", // Q
    b"11110 10001 10001 11110 10100 10010 10001", // R
    b"01111 10000 10000 01110 00001 00001 11110", // S
    b"11111 00100 00100 00100 00100 00100 00100", // T
    b"10001 10001 10001 10001 10001 10001 01110", // U
    b"10001 10001 10001 01010 01010 01010 00100", // V
    b"10001 10001 10001 10101 10101 11011 10001", // W
    b"10001 10001 01010 00100 01010 10001 10001", // X
    b"10001 10001 01010 00100 00100 00100 00100", // Y
    b"11111 00001 00010 00100 01000 10000 11111", // Z
    b"01110 01000 01000 01000 01000 01000 01110", // [
    b"10000 10000 01000 00100 00010 00001 00001", // backslash
    b"01110 00010 00010 00010 00010 00010 01110", // ]
    b"00100 01010 10001 00000 00000 00000 00000", // ^
    b"00000 00000 00000 00000 00000 00000 11111", // _
    b"01000 00100 00010 00000 00000 00000 00000", // `
    b"00000 00000 01110 00001 01111 10001 01111", // a
    b"10000 10000 11110 10001 10001 10001 11110", // b
    b"00000 00000 01111 10000 10000 10000 01111", // c
    b"00001 00001 01111 10001 10001 10001 01111", // d
    b"00000 00000 01110 10001 11111 10000 01111", // e
    b"00110 01000 11110 01000 01000 01000 01000", // f
    b"00000 01111 10001 10001 01111 00001 01110", // g
    b"10000 10000 11110 10001 10001 10001 10001", // h
    b"00100 00000 01100 00100 00100 00100 01110", // i
    b"00010 00000 00110 00010 00010 10010 01100", // j
    b"10000 10000 10010 10100 11000 10100 10010", // k
    b"01100 00100 00100 00100 00100 00100 01110", // l
    b"00000 00000 11110 10101 10101 10101 10101", // m
    b"00000 00000 11110 10001 10001 10001 10001", // n
    b"00000 00000 01110 10001 10001 10001 01110", // o
    b"00000 11110 10001 10001 11110 10000 10000", // p
    b"00000 01111 10001 10001 01111 00001 00001", // q
    b"00000 00000 10111 11000 10000 10000 10000", // r
    b"00000 00000 01111 10000 01110 00001 11110", // s
    b"01000 01000 11110 01000 01000 01001 00110", // t
    b"00000 00000 10001 10001 10001 10011 01101", // u
    b"00000 00000 10001 10001 01010 01010 00100", // v
    b"00000 00000 10001 10101 10101 10101 01010", // w
    b"00000 00000 10001 01010 00100 01010 10001", // x
    b"00000 10001 10001 10001 01111 00001 01110", // y
    b"00000 00000 11111 00010 00100 01000 11111", // z
    b"00011 00100 00100 01000 00100 00100 00011", // {
    b"00100 00100 00100 00100 00100 00100 00100", // |
    b"11000 00100 00100 00010 00100 00100 11000", // }
    b"00000 00000 01001 10101 10010 00000 00000", // ~
];

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_scene::Font;

    /// Every cell of every glyph is dark exactly where its drawing says so.
    #[test]
    fn outlines_fill_the_cells() {
        let font = Font::parse("built in", substitute("helvet.fnt").unwrap().as_bytes()).unwrap();
        assert!(font.glyph(b' ').unwrap().is_blank());
        for (code, drawing) in (FIRST..).zip(ROWS) {
            let glyph = font.glyph(code).unwrap();
            for (row, cells) in drawing.split(|&b| b == b' ').enumerate() {
                assert_eq!(cells.len(), COLUMNS);
                for (column, &cell) in cells.iter().enumerate() {
                    for (dx, dy) in [(0.5, 0.5), (0.05, 0.9), (0.97, 0.03)] {
                        let x = LEFT as f64 + COLUMN as f64 * (column as f64 + dx);
                        let y = BOTTOM as f64 + ROW as f64 * ((6 - row) as f64 + dy);
                        assert_eq!(glyph.covers(x, y), cell == b'1', "{} {row} {column}", code as char);
                    }
                }
            }
            assert!(!glyph.covers(5.0, 5.0) && !glyph.covers(250.0, 100.0));
        }
        assert_eq!(substitute("other.fnt"), None);
    }
}
