//! topng: pictures become PNG files of the right size, whole or not at all.

use ambit_tests::programs::foreign;
use ambit_tests::{Fixture, Program};

/// Width and height as a PNG's first chunk says.
fn size(png: &[u8]) -> (u32, u32) {
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n", "no PNG");
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().expect("four bytes"));
    (number(16), number(20))
}

#[test]
fn a_picture_becomes_a_png() {
    if foreign() {
        return; // topng is ours alone.
    }
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let fixture = Fixture::named("cornell");
    let octree = fixture.compile(scratch.path());
    let rpict = Program::new("rpict").line("-ab 0 -x 33 -y 33 -vf").arg(&fixture.views[0]).arg(&octree);
    std::fs::write(scratch.path().join("p.hdr"), rpict.run().well("rpict").out).expect("a scratch folder");
    for (options, wanted) in [("", (33, 33)), ("-s 2", (16, 16)), ("-e -1 -s 1", (33, 33))] {
        let topng = Program::new("topng").line(options).line("p.hdr p.png").within(scratch.path());
        topng.run().well("topng");
        assert_eq!(size(&std::fs::read(scratch.path().join("p.png")).expect("it was made")), wanted, "{options}");
    }
}

#[test]
fn what_is_no_picture_leaves_the_png_alone() {
    if foreign() {
        return;
    }
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let write = |name: &str, bytes: &[u8]| std::fs::write(scratch.path().join(name), bytes).expect("a scratch folder");
    write("old.png", b"precious");
    write("text.hdr", b"no picture\n");
    for (line, word) in
        [("text.hdr old.png", "text.hdr"), ("nosuch.hdr old.png", "nosuch.hdr"), ("-s 0 text.hdr old.png", "-s")]
    {
        let answer = Program::new("topng").line(line).within(scratch.path()).run();
        assert_eq!(answer.status, Some(1), "{line}");
        assert!(answer.err.contains(word), "{line}: {}", answer.err);
        assert_eq!(std::fs::read(scratch.path().join("old.png")).expect("it was there"), b"precious", "{line}");
    }
}
