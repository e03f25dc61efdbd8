use super::{Highlight, LensLight};

/// The small lights and highlights at which camera samples are aimed.
#[derive(Clone, Debug, Default)]
pub struct SmallHighlights {
    /// Those that are seen sharply, each in a small part of the film.
    pub on_film: Vec<Highlight>,
    /// Those that the lens blurs: a point of the film sees each through a small part of the lens.
    pub on_lens: Vec<LensLight>,
}
