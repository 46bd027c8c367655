//! View options, `-v*`.

use crate::common::Carries;
use crate::table::{Label, Place, Row};
use ambit_file::{View, ViewType};

/// The rows of the view, in the order of `-defaults`.
pub(crate) fn view_rows<S: Carries<View>>() -> Vec<Row<S>> {
    let one = |flag, place, label, values, help| Row::new(flag, Place::Real(place), help).shown(label).values(values);
    let three = |flag, place, label, help| Row::new(flag, Place::Vector(place), help).shown(label).values("X Y Z");
    vec![
        Row::new(
            "vt",
            Place::Glued(
                |tail| tail.chars().count() == 1,
                |s: &mut S, tail| {
                    s.part().kind = tail.chars().next().map_or(ViewType::Perspective, ViewType::from_letter);
                    Ok(())
                },
            ),
            "view type: v perspective, l parallel, c cylinder, h hemispherical, a angular, s planisphere",
        )
        .shown(Label::Own(|s| {
            let kind = s.part().kind;
            Label::tabs(&format!("-vt{}", kind.letter()), 4, &format!("view type {}", name(kind)))
        }))
        .values("TYPE"),
        three("vp", |s| &mut s.part().point, Label::Plain("view point"), "view point"),
        three(
            "vd",
            |s| &mut s.part().direction,
            Label::Plain("view direction"),
            "view direction; its length is the distance in focus",
        ),
        three("vu", |s| &mut s.part().up, Label::Plain("view up"), "what is up in the image"),
        one(
            "vh",
            |s| &mut s.part().horizontal,
            Label::Plain("view horizontal size"),
            "SIZE",
            "horizontal size in degrees (parallel: scene units)",
        ),
        one(
            "vv",
            |s| &mut s.part().vertical,
            Label::Plain("view vertical size"),
            "SIZE",
            "vertical size in degrees (parallel: scene units)",
        ),
        one(
            "vo",
            |s| &mut s.part().fore,
            Label::Plain("view fore clipping plane"),
            "DISTANCE",
            "leave out what is nearer; 0 for nothing",
        ),
        one(
            "va",
            |s| &mut s.part().aft,
            Label::Plain("view aft clipping plane"),
            "DISTANCE",
            "leave out what is farther; 0 for nothing",
        ),
        one("vs", |s| &mut s.part().shift, Label::Plain("view shift"), "WIDTHS", "shift to the right, in image widths"),
        one("vl", |s| &mut s.part().lift, Label::Plain("view lift"), "HEIGHTS", "lift, in image heights"),
        Row::new(
            "vf",
            Place::Word(|s: &mut S, file, outside| outside.view(s.part(), &file)),
            "read view options from a view file or a picture; - for standard input",
        )
        .values("FILE"),
    ]
}

fn name(kind: ViewType) -> &'static str {
    match kind {
        ViewType::Perspective => "perspective",
        ViewType::Parallel => "parallel",
        ViewType::Cylinder => "cylindrical",
        ViewType::Hemisphere => "hemispherical",
        ViewType::Angular => "angular",
        ViewType::Planisphere => "planisphere",
        ViewType::Unknown(_) => "unknown",
    }
}
