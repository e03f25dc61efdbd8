//! Spectra as authors write them, in the form that [`Curve`](crate::spectrum::Curve) shows.

use toml::de::DeValue;

use crate::scene::text::{Fields, Spanned, Value, exactly, spanned};
use crate::spectrum::{Channel, Encoding, Placement, Quantity, TexelFilter, Wrap};

/// Maximum number of repetitions in a unit. One over it is the minimum.
const MAX_REPEAT: f64 = 1e6;

/// A spectrum as written, each value with its place in the text.
#[derive(Clone)]
pub(super) struct CurveText<'d> {
    /// The whole spectrum.
    pub(super) value: Value<'d>,
    /// The value that gives its kind.
    pub(super) place: Value<'d>,
    pub(super) kind: KindText<'d>,
    /// The column of a file that holds the values, counted from 1.
    pub(super) column: Option<Spanned<'d, usize>>,
    pub(super) encoding: Option<Spanned<'d, Encoding>>,
    pub(super) channel: Option<Channel>,
    pub(super) wrap: Wrap,
    pub(super) filter: TexelFilter,
    /// Copies of an image or a pattern in a unit of u and of v.
    pub(super) repeat: Spanned<'d, [f64; 2]>,
    /// A factor on every value.
    pub(super) scale: Spanned<'d, f64>,
    /// CIE Y of an emission, in place of a factor.
    pub(super) luminance: Option<Spanned<'d, f64>>,
}

/// The ways to write a spectrum.
#[derive(Clone)]
pub(super) enum KindText<'d> {
    Number(f64),
    Name(&'d str),
    Rgb([f64; 3]),
    Samples(Vec<[f64; 2]>),
    File(&'d str),
    Cauchy([f64; 2]),
    Sellmeier { b: Spanned<'d, Vec<f64>>, c: Spanned<'d, Vec<f64>> },
    Abbe { nd: Spanned<'d, f64>, vd: Spanned<'d, f64> },
    Illuminant(&'d str),
    Blackbody(f64),
    Lines(Vec<[f64; 2]>),
    Image(&'d str),
    Checker(Box<[CurveText<'d>; 2]>),
}

type SpectrumReader = for<'d> fn(Value<'d>) -> Option<KindText<'d>>;

/// The keys that give the kind of a spectrum, and their readers. A table has exactly one of these keys.
const KINDS: [(&str, SpectrumReader); 11] = [
    ("rgb", |value| value.array(finite_number).map(KindText::Rgb)),
    ("samples", |value| pairs(value, "write [wavelength in nm, value]").map(KindText::Samples)),
    ("file", |value| value.text().map(KindText::File)),
    ("cauchy", |value| {
        value.as_list("", "write [A, B] of n = A + B / wavelength^2").array(finite_number).map(KindText::Cauchy)
    }),
    ("sellmeier", |value| {
        Fields::read(value, |table| {
            let b = table.need("b", spanned(|value: Value| value.list(finite_number)));
            let c = table.need("c", spanned(|value: Value| value.list(finite_number)));
            Some(KindText::Sellmeier { b: b?, c: c? })
        })
    }),
    ("abbe", |value| {
        Fields::read(value, |table| {
            let nd = table.need("nd", spanned(finite_number));
            let vd = table.need("vd", spanned(finite_number));
            Some(KindText::Abbe { nd: nd?, vd: vd? })
        })
    }),
    ("illuminant", |value| value.text().map(KindText::Illuminant)),
    ("blackbody", |value| finite_number(value).map(KindText::Blackbody)),
    ("lines", |value| pairs(value, "write [wavelength in nm, power]").map(KindText::Lines)),
    ("image", |value| value.text().map(KindText::Image)),
    ("checker", |value| {
        let cells = value.list(|entry| CurveText::read(entry, Quantity::Reflectance))?;
        let other = |count| value.refuse_key(format!("a `checker` is a list of 2 spectra, not of {count}"), None);
        Some(KindText::Checker(Box::new(exactly(cells, other)?)))
    }),
];

fn pairs(value: Value, help: &'static str) -> Option<Vec<[f64; 2]>> {
    let lists = value.node().as_array().map(|lists| lists.iter().map(|list| list.get_ref().as_array()));
    let lengths: Vec<Option<usize>> = lists.into_iter().flatten().map(|list| list.map(|list| list.len())).collect();
    let help = if matches!(lengths[..], [Some(a), Some(b)] if a == b) { PAIRS_HELP } else { help };
    value.list(|entry| entry.as_list("", help).array(finite_number))
}

/// The help for wavelengths and values that stand in two separate lists.
pub(super) const PAIRS_HELP: &str = "write a pair for each wavelength, as in [[400, 0.2], [700, 0.9]]";

/// Reads a number that can be part of a spectrum.
fn finite_number(value: Value) -> Option<f64> {
    let number = value.number()?;
    check_finite(Spanned { place: value, value: number }).map(|()| number)
}

pub(super) fn check_finite(Spanned { place, value: number }: Spanned<f64>) -> Option<()> {
    if number.is_finite() { Some(()) } else { place.refuse(not_finite(number)) }
}

pub(super) fn not_finite(x: f64) -> String {
    format!("a spectrum is made of finite numbers, not {x}")
}

const COLOR_EXAMPLE: &str = "{ rgb = [0.7, 0.5, 0.3] }";

/// Returns the keys that can give the kind of a spectrum of a quantity.
fn allowed_keys(quantity: Quantity) -> &'static [&'static str] {
    match quantity {
        Quantity::Index => &["rgb", "samples", "file", "cauchy", "sellmeier", "abbe"],
        Quantity::Emission => &["rgb", "samples", "file", "illuminant", "blackbody", "lines", "image", "checker"],
        Quantity::Reflectance | Quantity::Transmittance | Quantity::Share => {
            &["rgb", "samples", "file", "image", "checker"]
        }
        Quantity::Absorption | Quantity::MetalIndex | Quantity::MetalExtinction => &["rgb", "samples", "file"],
        Quantity::Excitation | Quantity::Fluorescence => &["samples", "file"],
        Quantity::Thickness => &["image", "checker"],
    }
}

/// Returns the keys that only spectra of other quantities can have.
fn foreign_keys(quantity: Quantity) -> impl Iterator<Item = &'static str> {
    let allowed_keys = allowed_keys(quantity);
    let varies = allowed_keys.contains(&"image");
    let has_file = allowed_keys.contains(&"file");
    let others =
        [("column", has_file), ("encoding", varies), ("channel", varies), ("wrap", varies), ("filter", varies)];
    let more = [("repeat", varies), ("luminance", quantity == Quantity::Emission)];
    let kinds = KINDS.iter().map(move |(key, _)| (*key, allowed_keys.contains(key)));
    kinds.chain(others).chain(more).filter(|(_, fits)| !fits).map(|(key, _)| key)
}

/// Returns the message about a table without a kind.
fn missing_kind_message(quantity: Quantity) -> String {
    let names: Vec<_> = allowed_keys(quantity).iter().map(|key| format!("`{key}`")).collect();
    let (others, last) = names.split_at(names.len() - 1);
    format!("a spectrum needs one of {} or {}", others.join(", "), last.concat())
}

/// Returns an example of a spectrum, for the message about one without a kind.
fn example(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Index => "\"N-BK7\" or { cauchy = [1.5046, 0.0042] }",
        Quantity::Emission => "{ illuminant = \"D65\" }",
        Quantity::Reflectance | Quantity::Transmittance | Quantity::Share => COLOR_EXAMPLE,
        Quantity::Absorption | Quantity::MetalIndex | Quantity::MetalExtinction => COLOR_EXAMPLE,
        Quantity::Excitation | Quantity::Fluorescence => "{ samples = [[400, 0.2], [450, 0.9], [500, 0]] }",
        Quantity::Thickness => "{ image = \"thickness.png\", scale = 600 }",
    }
}

impl<'d> CurveText<'d> {
    /// Reads a value as a spectrum.
    pub(super) fn read(value: Value<'d>, quantity: Quantity) -> Option<Self> {
        match value.node() {
            DeValue::Integer(_) | DeValue::Float(_) => {
                finite_number(value).map(|number| Self::plain(value, KindText::Number(number)))
            }
            DeValue::String(name) => Some(Self::plain(value, KindText::Name(name))),
            DeValue::Table(_) => Fields::read(value, |table| curve_table(value, table, quantity)),
            _ => value.expected("a number, a catalog name in quotes, or a table such as { rgb = [r, g, b] }"),
        }
    }

    /// Returns whether a spectrum of a quantity may be written in this form. A name may always be, whatever it stands
    /// for.
    pub(super) fn fits(&self, quantity: Quantity) -> bool {
        match self.kind {
            KindText::Name(_) => true,
            KindText::Number(_) => quantity != Quantity::Fluorescence,
            _ => allowed_keys(quantity).contains(&self.place.key()),
        }
    }

    /// Returns the placement of its image, if that is possible.
    pub(super) fn placement(&self) -> Option<Placement> {
        Some(Placement { repeat: check_repeat(self.repeat)?, wrap: self.wrap, filter: self.filter })
    }

    /// Returns a spectrum that is not written as a table.
    fn plain(value: Value<'d>, kind: KindText<'d>) -> Self {
        let (scale, repeat) = (Spanned { place: value, value: 1.0 }, Spanned { place: value, value: [1.0; 2] });
        let (column, encoding, channel, luminance) = (None, None, None, None);
        let (wrap, filter) = (Wrap::default(), TexelFilter::default());
        Self { value, place: value, kind, column, encoding, channel, wrap, filter, repeat, scale, luminance }
    }
}

fn curve_table<'d>(value: Value<'d>, table: &mut Fields<'d>, quantity: Quantity) -> Option<CurveText<'d>> {
    table.exclude_hints(foreign_keys(quantity));
    let kinds = KINDS.map(|(key, read)| table.get(key).map(|place| (place, read(place))));
    let column = table.maybe("column", spanned(|value: Value| value.whole_number(0..=u64::MAX)));
    let encoding = table.maybe("encoding", spanned(|value: Value| value.word(&ENCODINGS)));
    let channel = table.maybe("channel", |value| value.word(&CHANNELS));
    let wrap = table.or("wrap", Wrap::default(), |value| value.word(&WRAPS));
    let filter = table.or("filter", TexelFilter::default(), |value| value.word(&FILTERS));
    let repeat = table.or("repeat", Spanned { place: value, value: [1.0; 2] }, spanned(one_or_two));
    let scale = table.or("scale", Spanned { place: value, value: 1.0 }, spanned(Value::number));
    let luminance = table.maybe("luminance", spanned(Value::number));
    let mut given = kinds.into_iter().flatten();
    let Some((place, kind)) = given.next() else {
        let help = format!("such as {}", example(quantity));
        return if table.has_unknown() { None } else { value.advise(missing_kind_message(quantity), help) };
    };
    if let Some((other, _)) = given.next() {
        let message = format!("a spectrum has exactly one kind, not `{}` and `{}`", place.key(), other.key());
        return place.later(other).refuse_key(message, None);
    }
    let (kind, column, encoding, channel) = (kind?, column?, encoding?, channel?);
    let (wrap, filter, repeat, scale, luminance) = (wrap?, filter?, repeat?, scale?, luminance?);
    let is_image = matches!(kind, KindText::Image(_));
    let owners = [
        ("column", "`file`", matches!(kind, KindText::File(_))),
        ("encoding", "`image`", is_image),
        ("channel", "`image`", is_image),
        ("wrap", "`image`", is_image),
        ("filter", "`image`", is_image),
        ("repeat", "`image` or `checker`", is_image || matches!(kind, KindText::Checker(_))),
    ];
    for (key, owner, has_it) in owners {
        if let Some(stray) = table.get(key).filter(|_| !has_it) {
            return stray.refuse_key(format!("`{key}` applies only to {owner}"), None);
        }
    }
    if let (Some(scale), Some(luminance)) = (table.get("scale"), table.get("luminance")) {
        return scale.later(luminance).refuse_key("a spectrum has a `scale` or a `luminance`, not both", None);
    }
    Some(CurveText { value, place, kind, column, encoding, channel, wrap, filter, repeat, scale, luminance })
}

/// Reads how many copies of an image or a pattern there are in a unit of u and of v: one number or two.
pub(super) fn repeat(value: Value) -> Option<[f64; 2]> {
    check_repeat(Spanned { place: value, value: one_or_two(value)? })
}

fn one_or_two(value: Value) -> Option<[f64; 2]> {
    value.as_list("", "write [along u, along v]").one_or("[u, v]")
}

/// Checks that numbers of copies in a unit are neither too large nor too small.
pub(super) fn check_repeat(Spanned { place: value, value: repeat }: Spanned<[f64; 2]>) -> Option<[f64; 2]> {
    match repeat.iter().find(|x| !(1.0 / MAX_REPEAT..=MAX_REPEAT).contains(*x)) {
        Some(wrong) => value.refuse(format!(
            "`repeat` is the number of copies in a unit, {:e} to {MAX_REPEAT:e}, not {wrong}",
            1.0 / MAX_REPEAT
        )),
        None => Some(repeat),
    }
}

pub(super) const CHANNELS: [(&str, Channel); 4] =
    [("red", Channel::Red), ("green", Channel::Green), ("blue", Channel::Blue), ("alpha", Channel::Alpha)];
pub(super) const ENCODINGS: [(&str, Encoding); 2] = [("srgb", Encoding::Srgb), ("linear", Encoding::Linear)];
pub(super) const WRAPS: [(&str, Wrap); 3] =
    [("repeat", Wrap::Repeat), ("clamp", Wrap::Clamp), ("mirror", Wrap::Mirror)];
const FILTERS: [(&str, TexelFilter); 2] = [("linear", TexelFilter::Linear), ("nearest", TexelFilter::Nearest)];
