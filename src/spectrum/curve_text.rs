//! How a spectrum is read from a scene file.

use std::fmt;

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error as _, MapAccess, Visitor};

use super::texture::number_or_two;
use super::{Channel, Curve, CurveKind, Encoding, ImageText, Placement, TexelFilter, Wrap};

const EXPECTED: &str = "a number, a catalog name in quotes, or a table such as { rgb = [r, g, b] }";
const NEEDS: &str = "a spectrum needs one of `rgb`, `samples`, `file`, `cauchy`, `sellmeier`, `abbe`, `illuminant`, `blackbody`, `lines`, `image` or `checker`";

impl<'de> Deserialize<'de> for Curve {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(CurveVisitor)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CurveTable {
    rgb: Option<[f64; 3]>,
    samples: Option<Vec<[f64; 2]>>,
    cauchy: Option<[f64; 2]>,
    sellmeier: Option<Sellmeier>,
    abbe: Option<Abbe>,
    file: Option<String>,
    column: Option<usize>,
    illuminant: Option<String>,
    blackbody: Option<f64>,
    lines: Option<Vec<[f64; 2]>>,
    image: Option<String>,
    encoding: Option<Encoding>,
    channel: Option<Channel>,
    wrap: Option<Wrap>,
    filter: Option<TexelFilter>,
    checker: Option<Vec<Curve>>,
    #[serde(default, deserialize_with = "number_or_two")]
    repeat: Option<[f64; 2]>,
    scale: Option<f64>,
    luminance: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Sellmeier {
    b: Vec<f64>,
    c: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Abbe {
    nd: f64,
    vd: f64,
}

struct CurveVisitor;

impl<'de> Visitor<'de> for CurveVisitor {
    type Value = Curve;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(EXPECTED)
    }

    fn visit_f64<E>(self, value: f64) -> Result<Curve, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Curve, E> {
        Ok((value as f64).into())
    }

    fn visit_str<E>(self, name: &str) -> Result<Curve, E> {
        Ok(CurveKind::Name(name.to_owned()).into())
    }

    fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<Curve, M::Error> {
        let table = CurveTable::deserialize(MapAccessDeserializer::new(map))?;
        let repeat = table.repeat.unwrap_or([1.0; 2]);
        let placement =
            Placement { repeat, wrap: table.wrap.unwrap_or_default(), filter: table.filter.unwrap_or_default() };
        let (encoding, channel) = (table.encoding, table.channel);
        let of_image = |file| CurveKind::Image(ImageText { file, encoding, channel, placement });
        let cells = match table.checker.map(<[Curve; 2]>::try_from) {
            Some(Err(cells)) => {
                let message = format!("a `checker` is a list of 2 spectra, not of {}", cells.len());
                return Err(M::Error::custom(message));
            }
            cells => cells.and_then(Result::ok),
        };
        let mut kinds = [
            ("rgb", table.rgb.map(CurveKind::Rgb)),
            ("samples", table.samples.map(CurveKind::Samples)),
            ("cauchy", table.cauchy.map(CurveKind::Cauchy)),
            ("sellmeier", table.sellmeier.map(|s| CurveKind::Sellmeier { b: s.b, c: s.c })),
            ("abbe", table.abbe.map(|a| CurveKind::Abbe { nd: a.nd, vd: a.vd })),
            ("file", table.file.map(|file| CurveKind::File { file, column: table.column.unwrap_or(2) })),
            ("illuminant", table.illuminant.map(CurveKind::Illuminant)),
            ("blackbody", table.blackbody.map(CurveKind::Blackbody)),
            ("lines", table.lines.map(CurveKind::Lines)),
            ("image", table.image.map(of_image)),
            ("checker", cells.map(|cells| CurveKind::Checker { cells: Box::new(cells), repeat })),
        ]
        .into_iter()
        .filter_map(|(key, kind)| Some((key, kind?)));
        let Some((key, kind)) = kinds.next() else {
            return Err(M::Error::custom(NEEDS));
        };
        if let Some((other, _)) = kinds.next() {
            return Err(M::Error::custom(format!("a spectrum has exactly one kind, not `{key}` and `{other}`")));
        }
        if table.column.is_some() && !matches!(kind, CurveKind::File { .. }) {
            return Err(M::Error::custom("`column` goes with `file`"));
        }
        let of_an_image = [
            ("encoding", table.encoding.is_some()),
            ("channel", table.channel.is_some()),
            ("wrap", table.wrap.is_some()),
            ("filter", table.filter.is_some()),
        ];
        if let Some((key, _)) = of_an_image.iter().find(|key| key.1 && !matches!(kind, CurveKind::Image(_))) {
            return Err(M::Error::custom(format!("`{key}` goes with `image`")));
        }
        if table.repeat.is_some() && !matches!(kind, CurveKind::Image(_) | CurveKind::Checker { .. }) {
            return Err(M::Error::custom("`repeat` goes with `image` or `checker`"));
        }
        if table.scale.is_some() && table.luminance.is_some() {
            return Err(M::Error::custom("a spectrum has a `scale` or a `luminance`, not both"));
        }
        Ok(Curve { kind, scale: table.scale.unwrap_or(1.0), luminance: table.luminance })
    }
}
