//! Meshes: what rtrace tells of them.

use ambit_tests::Program;

/// The name, modifier and material that a ray meets: `M-Tri`, as Radiance calls triangles of materials of their own, or the
/// mesh whose material they have, or which gives them none.
#[test]
fn triangles_bear_the_name_of_what_has_their_material() {
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let write = |name: &str, bytes: &[u8]| std::fs::write(scratch.path().join(name), bytes).expect("a scratch folder");
    write("m.mat", b"void plastic own 0 0 5 .5 .5 .5 0 0\n");
    let corners = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\n";
    for (choice, modifier, wanted) in
        [("usemtl own", "void", "M-Tri own own"), ("usemtl own", "red", "m red red"), ("", "void", "m void void")]
    {
        write("m.obj", format!("{corners}{choice}\nf 1 2 3\n").as_bytes());
        let mesh = Program::new("obj2mesh").line("-a m.mat m.obj").within(scratch.path()).run().well("obj2mesh");
        write("m.rtm", &mesh.out);
        write("s.rad", format!("void plastic red 0 0 5 .5 0 0 0 0 {modifier} mesh m 1 m.rtm 0 0\n").as_bytes());
        let octree = Program::new("oconv").line("s.rad").within(scratch.path()).run().well("oconv");
        write("s.oct", &octree.out);
        let answer = Program::new("rtrace").line("-h -w- -osmM s.oct").within(scratch.path()).feed(b"0 0 1 0 0 -1\n");
        let text = answer.well("rtrace").text();
        assert_eq!(text.split_whitespace().collect::<Vec<_>>().join(" "), wanted, "{modifier}");
    }
}
