//! SVG to PNG with fonts of its own, so that a figure looks the same on every machine.

use super::canvas::FAMILY;
use super::error::FigureError;
use resvg::{tiny_skia, usvg};
use std::sync::{Arc, OnceLock};

/// Largest number of pixels of a picture: 400 MB while it is drawn.
const MAX_PIXELS: u64 = 100_000_000;

/// The figure's font, and a second one for mathematical signs that the first does not have.
fn fonts() -> &'static Arc<usvg::fontdb::Database> {
    static FONTS: OnceLock<Arc<usvg::fontdb::Database>> = OnceLock::new();
    FONTS.get_or_init(|| {
        let mut fonts = usvg::fontdb::Database::new();
        fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
        fonts.load_font_data(epaint_default_fonts::HACK_REGULAR.to_vec());
        fonts.set_sans_serif_family(FAMILY);
        Arc::new(fonts)
    })
}

/// A picture with `scale` pixels per unit of the SVG's size.
pub(super) fn png(svg: &str, scale: f64) -> Result<Vec<u8>, FigureError> {
    let options =
        usvg::Options { fontdb: Arc::clone(fonts()), font_family: FAMILY.to_owned(), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options).map_err(|error| FigureError::Drawing(error.to_string()))?;
    let [width, height] = [tree.size().width(), tree.size().height()].map(|side| (f64::from(side) * scale).ceil());
    // The comparison is false for NaN.
    if !(width >= 1.0 && height >= 1.0 && width * height <= MAX_PIXELS as f64) {
        return Err(FigureError::Scale { value: scale, most: MAX_PIXELS });
    }
    let mut pixels = tiny_skia::Pixmap::new(width as u32, height as u32)
        .ok_or(FigureError::Scale { value: scale, most: MAX_PIXELS })?;
    let transform = tiny_skia::Transform::from_scale(scale as f32, scale as f32);
    resvg::render(&tree, transform, &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| FigureError::Drawing(error.to_string()))
}
