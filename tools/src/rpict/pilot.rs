//! The pilot of a picture (`--error`): a lattice of its own pixels, so that errors are those of the picture.

use super::frame::{Frame, set_up};
use super::recover;
use super::shots::Shots;
use crate::goal::{self, Goal, SIDE};
use crate::light::Scene;
use crate::session::{Session, Stop};
use ambit_cli::{Failure, PictureOptions};
use ambit_file::{PixelSpace, Projection, path_of};
use ambit_render::Options;
use ambit_render::picture::{Camera, Lens, Order, Pixel, PixelRequest, Sampler};

/// Chooses the settings for the picture that the options ask for.
pub(super) fn choose(
    session: &Session,
    options: &PictureOptions,
    space: PixelSpace,
    scene: &mut Scene<'_>,
    error: f64,
) -> Result<Options, Stop> {
    if options.sequence > 0 {
        return Err(Failure::unsupported("--error with a sequence of views (-S) is").into());
    }
    let frame = Frame::new(view(session, options, space)?, options);
    let mut pilot = |scene: &mut Scene<'_>| values(&frame, options, scene);
    let goal = Goal { error, options: &options.rendering.options, unit: "pixels" };
    goal::choose(session, scene, &goal, &mut pilot)
}

/// The view, which a recovered picture brings along.
fn view(session: &Session, options: &PictureOptions, space: PixelSpace) -> Result<Projection, Stop> {
    let file = options.recover.as_deref().filter(|file| path_of(file).exists());
    let recovered = file.and_then(|file| recover::read(session, file, path_of(file), space));
    Ok(set_up(recovered.and_then(|r| r.view).as_ref().unwrap_or(&options.view))?)
}

/// The pixels of the pilot; those outside the view are black, as in the picture.
fn values(frame: &Frame, options: &PictureOptions, scene: &mut Scene<'_>) -> Result<Vec<[f32; 3]>, Stop> {
    let (width, height) = (frame.width.min(SIDE), frame.height.min(SIDE));
    // The same number of rays leave the eye whatever the settings, in the order of a picture with a cache.
    let order = Order::CoarseToFine;
    let sampler = Sampler { width, rows: height, height, spacing: 1, threshold: 0.0, distances: false, order };
    let camera = Camera {
        projection: frame.view,
        previous: None,
        width: frame.width,
        height: frame.height,
        lens: Lens { jitter: options.jitter, aperture: options.aperture, motion: 0.0 },
        seed: options.rendering.options.seed,
    };
    let place = |k: u32, few: u32, many: u32| ((2 * k + 1) * many) / (2 * few);
    let mut values = Vec::new();
    let mut shots = Shots::default();
    sampler.run(
        &mut |pixels: &[PixelRequest]| -> Result<Vec<Pixel>, Stop> {
            let ray = |p: PixelRequest| {
                let (x, y) = (place(p.x, width, frame.width), place(p.y, height, frame.height));
                camera.ray(PixelRequest { x, y, index: p.index })
            };
            shots.trace(pixels, &ray, scene, &|seen| Pixel { colour: seen.value, distance: 0.0 })
        },
        &mut |band| {
            values.extend(band.rows.iter().flatten().map(|pixel| pixel.colour.to_array()));
            Ok(())
        },
    )?;
    Ok(values)
}
