//! Draws marks on a scene.

use kuva::render::render::{Primitive, Scene, TextAnchor};

/// Draws on a scene.
pub(super) struct Pen(pub(super) Scene);

impl Pen {
    #[allow(clippy::too_many_arguments, reason = "one for each property of a text")]
    pub(super) fn text(
        &mut self,
        x: f64,
        y: f64,
        content: &str,
        size: u32,
        anchor: TextAnchor,
        bold: bool,
        colour: &str,
    ) {
        self.0.add(Primitive::Text {
            x,
            y,
            content: content.to_owned(),
            size,
            anchor,
            rotate: None,
            bold,
            color: Some(colour.into()),
        });
    }

    pub(super) fn rectangle(&mut self, x: f64, y: f64, width: f64, height: f64, colour: &str) {
        self.0.add(Primitive::Rect {
            x,
            y,
            width,
            height,
            fill: colour.into(),
            stroke: None,
            stroke_width: None,
            opacity: None,
        });
    }

    pub(super) fn line(&mut self, from: (f64, f64), to: (f64, f64), colour: &str, width: f64) {
        self.0.add(Primitive::Line {
            x1: from.0,
            y1: from.1,
            x2: to.0,
            y2: to.1,
            stroke: colour.into(),
            stroke_width: width,
            stroke_dasharray: None,
        });
    }

    pub(super) fn disc(&mut self, centre: (f64, f64), radius: f64, colour: &str) {
        self.0.add(Primitive::Circle {
            cx: centre.0,
            cy: centre.1,
            r: radius,
            fill: colour.into(),
            fill_opacity: None,
            stroke: None,
            stroke_width: None,
        });
    }

    pub(super) fn ring(&mut self, centre: (f64, f64), radius: f64, colour: &str, ground: &str) {
        self.0.add(Primitive::Circle {
            cx: centre.0,
            cy: centre.1,
            r: radius,
            fill: ground.into(),
            fill_opacity: None,
            stroke: Some(colour.into()),
            stroke_width: Some(1.4),
        });
    }

    pub(super) fn cross(&mut self, centre: (f64, f64), radius: f64, colour: &str) {
        for side in [-radius, radius] {
            let (x, y) = centre;
            self.line((x - radius, y - side), (x + radius, y + side), colour, 1.6);
        }
    }
}
