//! What the tables hold.

use super::rows::{Rows, compare, key_of};
use super::*;

const TABLES: [&str; 3] = [include_str!("glasses.txt"), include_str!("metals.txt"), include_str!("colors.txt")];

#[test]
fn keys_are_sorted_and_unique_and_found() {
    for text in TABLES {
        let rows = Rows::new(text);
        let lines: Vec<_> = rows.all().collect();
        assert!(lines.windows(2).all(|pair| compare(key_of(pair[0]), key_of(pair[1])).is_lt()));
        assert!(lines.iter().all(|line| rows.find(&key_of(line).to_uppercase()) == Some(*line)));
        assert!(["", "zz", "schott", "schott/", "#", "a", "schott/N-BK"].iter().all(|key| rows.find(key).is_none()));
    }
}

#[test]
fn every_line_parses() {
    let finite = |values: &[f64]| !values.is_empty() && values.iter().all(|value| value.is_finite());
    for glass in glasses() {
        let Glass { key, range_nm: (low, high), .. } = glass;
        assert!(low < 700.0 && high > 400.0 && !glass.source.is_empty(), "{key}");
        let ok = match &glass.formula {
            Formula::Tabulated(samples) => samples.len() > 1 && samples.is_sorted_by(|a, b| a[0] < b[0]),
            Formula::Poles(c) => finite(c) && (c.len() - 1).min(8) % 4 == 0 && c.len() % 2 == 1,
            Formula::Sellmeier(c) | Formula::SellmeierSquared(c) | Formula::Polynomial(c) => {
                finite(c) && c.len() % 2 == 1
            }
            Formula::Cauchy(c) | Formula::Gas(c) => finite(c) && c.len() % 2 == 1,
        };
        assert!(ok, "{key}: {:?}", glass.formula);
        assert!(glass.extinction.is_sorted_by(|a, b| a[0] < b[0]), "{key}");
        assert!(glass.extinction.iter().all(|[_, k]| (0.0..1.0).contains(k)), "{key}");
    }
    for metal in metals() {
        assert!(metal.samples.is_sorted_by(|a, b| a[0] < b[0]) && !metal.source.is_empty(), "{}", metal.name);
        assert!(metal.samples.iter().all(|[nm, n, k]| *nm > 0.0 && *n > 0.0 && *k >= 0.0), "{}", metal.name);
        assert!(metal.samples[0][0] <= 400.0 && metal.samples[metal.samples.len() - 1][0] >= 700.0, "{}", metal.name);
    }
    assert!(illuminants().all(|light| finite(&light.values) && light.step_nm > 0.0 && !light.source.is_empty()));
    assert!(reflectances().all(|chip| chip.values.iter().all(|value| (0.0..=1.0).contains(value))));
    assert_eq!((illuminants().count(), reflectances().count()), (49, 24));
}

#[test]
fn names_stand_for_one_material() {
    let mut names: Vec<_> = metals().flat_map(|metal| [vec![metal.name], metal.aliases].concat()).collect();
    names.iter().for_each(|name| assert!(metal(name).is_some(), "{name}"));
    let metal_names = names.len();
    names.sort_by(|a, b| compare(a, b));
    names.dedup_by(|a, b| a.eq_ignore_ascii_case(b));
    assert_eq!(names.len(), metal_names);
    for glass in glasses() {
        assert_eq!(super::glass(glass.key).map(|found| found.key), Some(glass.key));
        glass.aliases.iter().for_each(|alias| assert_eq!(glass_makers(alias), [glass.key]));
    }
}

#[test]
fn formulas_have_the_indices_that_makers_state() {
    let stated = glasses().filter_map(|glass| Some((glass.n_d() - glass.stated_nd?, glass.v_d()? - glass.stated_vd?)));
    // SUMITA states V_d to one decimal only, so that rounding alone takes up 0.05.
    let agrees = |(nd, vd): &(f64, f64)| nd.abs() <= 1.5e-5 && vd.abs() <= 0.1;
    let (agreeing, differing): (Vec<_>, Vec<_>) = stated.partition(agrees);
    assert!(agreeing.len() > 1570 && differing.len() * 100 <= 3 * (agreeing.len() + differing.len()), "{differing:?}");
}

#[test]
fn a_glass_not_known_from_blue_to_red_has_no_abbe_number() {
    let vd = |name: &str| super::glass(name).expect("it is in the catalog").v_d();
    // Known up to 644 nm, and from 495 nm on.
    assert_eq!([vd("heptane"), vd("oleic acid")], [None, None]);
    assert!(vd("N-BK7").is_some_and(|vd| (vd - 64.17).abs() < 0.005));
    // Helium disperses least of all.
    glasses().for_each(|glass| assert!(glass.v_d().is_none_or(|vd| vd < 240.0), "{}: {:?}", glass.key, glass.v_d()));
}

#[test]
fn water_absorbs_as_hale_and_querry_measured() {
    let k = super::glass("water").and_then(|water| water.extinction(700.0));
    assert_eq!(k, Some(3.35e-8));
}

#[test]
fn indices_are_those_of_the_data_sheets() {
    for (name, indices) in [
        ("N-BK7", [1.522376, 1.516800, 1.514322]),
        ("schott/n-sf11", [1.806513, 1.784720, 1.775955]),
        ("fused silica", [1.463126, 1.458464, 1.456367]),
    ] {
        let glass = glass(name).expect(name);
        for (nm, expected) in [486.1327, 587.5618, 656.2725].into_iter().zip(indices) {
            assert!((glass.index(nm) - expected).abs() < 1e-6, "{name} at {nm}: {}", glass.index(nm));
        }
    }
    assert!((glass("air").expect("air").n_d() - 1.000277).abs() < 1e-6);
}

#[test]
fn formulas_have_no_pole_in_visible_light() {
    for glass in glasses() {
        let indices: Vec<_> = (3600..=8300).map(|nm| glass.index(f64::from(nm) * 0.1)).collect();
        let steps = indices.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        assert!(indices.iter().all(|index| (1.0..4.0).contains(index)), "{}", glass.key);
        assert!(steps.fold(0.0, f64::max) < 2e-3, "{}", glass.key);
    }
}

#[test]
fn a_bare_name_stands_for_its_first_match() {
    assert_eq!(glass("f2").map(|glass| glass.key), Some("schott/F2"));
    assert_eq!(glass_makers("F2"), ["schott/F2", "cdgm/F2", "hikari/F2"]);
    assert_eq!(glass_makers("hikari/f2"), ["hikari/F2"]);
    let old = ["CaF2", "diamond", "fused silica", "silica", "SiO2", "sapphire", "water", "H2O", "fluorite", "SF10"];
    assert!(old.iter().all(|name| glass(name).is_some()));
    assert!(glass("Au").is_none() && glass("").is_none() && glass("schott/").is_none() && metal("").is_none());
    assert_eq!(metal("GOLD").map(|metal| metal.name), Some("Au"));
}

#[test]
fn tables_are_read_between_and_beyond_their_ends() {
    let a = illuminant("a").expect("illuminant A");
    assert_eq!((a.at(560.0), a.at(299.0), a.at(781.0), a.at(780.0)), (100.0, 0.0, 0.0, a.values[96]));
    assert!((a.at(562.5) - 0.5 * (a.at(560.0) + a.at(565.0))).abs() < 1e-9);
    let skin = reflectance("Dark Skin").expect("dark skin");
    assert_eq!(Some(&skin), reflectance("colorchecker/dark skin").as_ref());
    assert_eq!((skin.at(300.0), skin.at(380.0), skin.at(900.0)), (0.048, 0.048, skin.values[80]));
    let observer = color_matching();
    assert_eq!(observer[200], [0.5945, 0.995, 0.0039]);
    assert!((observer.iter().map(|xyz| xyz[1]).sum::<f64>() - 106.8566).abs() < 1e-3);
    let gold = metal("Au").expect("gold");
    assert_eq!((gold.nk(100.0), gold.nk(582.1)), ([1.48, 1.883], [0.29, 2.863]));
}
