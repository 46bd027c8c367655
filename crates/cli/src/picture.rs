//! Options of `rpict`.

use crate::common::{Carries, Common, colour_rows, persist_rows, thread_row, warning_row};
use crate::rendering::{Rendering, rendering_rows};
use crate::table::{Label, Place, Row};
use crate::viewing::view_rows;
use ambit_file::View;
use ambit_render::Options;

/// Every parameter of a run of `rpict`.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureOptions {
    /// Parameters of the light.
    pub rendering: Rendering,
    /// Parameters of the process.
    pub common: Common,
    /// The view.
    pub view: View,
    /// `-x`: greatest width.
    pub width: i32,
    /// `-y`: greatest height.
    pub height: i32,
    /// `-pa`: height over width of a pixel.
    pub pixel_aspect: f64,
    /// `-ps`: sample spacing in pixels.
    pub spacing: i32,
    /// `-pt`: relative difference above which a pixel between two others is traced.
    pub threshold: f64,
    /// `-pj`: fraction of a pixel over which samples are spread.
    pub jitter: f64,
    /// `-pm`: motion blur, in frames.
    pub motion: f64,
    /// `-pd`: diameter of the aperture.
    pub aperture: f64,
    /// `-o`: output file, or its pattern in sequences.
    pub output: Option<String>,
    /// `-z`: file of distances, or its pattern.
    pub distances: Option<String>,
    /// `-r`: picture, or frame number, to recover.
    pub recover: Option<String>,
    /// `-S`: number of the first frame; 0 or less for a single picture.
    pub sequence: i32,
    /// `-t`: seconds between reports.
    pub report: i32,
}

impl PictureOptions {
    /// The defaults on a machine with that many processors.
    pub fn new(processors: usize) -> Self {
        Self {
            rendering: Rendering::new(Options::rpict()),
            common: Common::new(processors),
            view: View::default(),
            width: 512,
            height: 512,
            pixel_aspect: 1.0,
            spacing: 4,
            threshold: 0.05,
            jitter: 0.67,
            motion: 0.0,
            aperture: 0.0,
            output: None,
            distances: None,
            recover: None,
            sequence: 0,
            report: 0,
        }
    }
}

impl Carries<Rendering> for PictureOptions {
    fn part(&mut self) -> &mut Rendering {
        &mut self.rendering
    }
}

impl Carries<Common> for PictureOptions {
    fn part(&mut self) -> &mut Common {
        &mut self.common
    }
}

impl Carries<View> for PictureOptions {
    fn part(&mut self) -> &mut View {
        &mut self.view
    }
}

/// The options of `rpict`, in the order of `-defaults`.
pub fn picture_table() -> Vec<Row<PictureOptions>> {
    let mut rows = view_rows();
    rows.extend([
        Row::new("x", Place::Integer(|s: &mut PictureOptions| &mut s.width), "greatest width in pixels")
            .shown(Label::Wide("x resolution"))
            .values("PIXELS"),
        Row::new("y", Place::Integer(|s: &mut PictureOptions| &mut s.height), "greatest height in pixels")
            .shown(Label::Wide("y resolution"))
            .values("PIXELS"),
    ]);
    rows.extend(colour_rows(|_| false));
    rows.extend(pixel_rows());
    rows.push(warning_row());
    rows.extend(rendering_rows());
    rows.extend(file_rows());
    rows.push(thread_row());
    rows.extend(persist_rows());
    rows
}

fn pixel_rows() -> Vec<Row<PictureOptions>> {
    let real = |flag, at, comment, values, help| {
        Row::new(flag, Place::Real(at), help).shown(Label::Plain(comment)).values(values)
    };
    vec![
        real(
            "pa",
            |s: &mut PictureOptions| &mut s.pixel_aspect,
            "pixel aspect ratio",
            "RATIO",
            "height over width of a pixel; 0 keeps -x and -y as they are",
        ),
        real("pj", |s| &mut s.jitter, "pixel jitter", "FRACTION", "spread samples over this fraction of a pixel"),
        real(
            "pm",
            |s| &mut s.motion,
            "pixel motion",
            "FRACTION",
            "motion blur: how much of a frame the shutter is open",
        ),
        real(
            "pd",
            |s| &mut s.aperture,
            "pixel depth-of-field",
            "DIAMETER",
            "diameter of the aperture; 0 for a pinhole",
        ),
        Row::new(
            "ps",
            Place::Integer(|s: &mut PictureOptions| &mut s.spacing),
            "trace every so many pixels at first; 1 for all",
        )
        .shown(Label::Plain("pixel sample"))
        .values("PIXELS"),
        real(
            "pt",
            |s| &mut s.threshold,
            "pixel threshold",
            "FRACTION",
            "trace the pixels between two that differ by more than this",
        ),
        Row::new(
            "t",
            Place::Integer(|s: &mut PictureOptions| &mut s.report),
            "report progress every so many seconds; 0 for never",
        )
        .shown(Label::Wide("time between reports"))
        .values("SECONDS"),
    ]
}

fn file_rows() -> Vec<Row<PictureOptions>> {
    let text = |flag, at, values, help| Row::new(flag, Place::Text(at), help).values(values);
    vec![
        text(
            "o",
            |s: &mut PictureOptions| &mut s.output,
            "FILE",
            "write the picture to a new file; in sequences a pattern such as frame%03d.hdr",
        ),
        text("z", |s| &mut s.distances, "FILE", "write the distance of every pixel to a file of 4-byte reals"),
        text("r", |s| &mut s.recover, "FILE", "go on with a picture that was interrupted"),
        Row::new(
            "ro",
            Place::Word(|s: &mut PictureOptions, file, _| {
                s.recover = Some(file.clone());
                s.output = Some(file);
                Ok(())
            }),
            "as -r and -o with the same file",
        )
        .values("FILE"),
        Row::new(
            "S",
            Place::Integer(|s: &mut PictureOptions| &mut s.sequence),
            "read views from standard input and number the pictures from this",
        )
        .values("FRAME"),
    ]
}
