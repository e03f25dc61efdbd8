"""The pages of the refractiveindex.info database that the catalog takes, besides the glasses of the makers."""

from typing import NamedTuple


class Material(NamedTuple):
    """A material: its key, its page in the database, its other names, and its source if the page does not cite one.

    A second page may give the absorption that the first lacks.
    """

    key: str
    page: str
    aliases: tuple[str, ...] = ()
    source: str = ""
    absorption: str = ""


def material(key, page, *aliases, source="", absorption=""):
    return Material(key, page, aliases, source, absorption)


def axes(key, page, *aliases, first="o", rest="e"):
    """Returns the entries of a birefringent crystal, one for each ray; the aliases name the first."""
    names = (key.partition("/")[2], *aliases)
    return [
        material(f"{key}-{first}", f"{page}{FULL.get(first, first)}", *names),
        *(material(f"{key}-{ray}", f"{page}{FULL.get(ray, ray)}") for ray in rest),
    ]


FULL = {"x": "alpha", "y": "beta", "z": "gamma"}

WATER = "Daimon and Masumura, Appl. Opt. 46, 3811 (2007), 20 °C"
SAPPHIRE = "Dodge, Handbook of Laser Science IV (1986), ordinary ray"
LEAD_FLUORIDE = "Malitson and Dodge, J. Opt. Soc. Am. 59, 500A (1969)"

CLEAR = [
    material("crystal/BaF2", "main/BaF2/nk/Malitson", "barium fluoride"),
    *axes("crystal/BaTiO3", "main/BaTiO3/nk/Wemple-", "barium titanate"),
    *axes("crystal/BBO", "main/BaB2O4/nk/Eimerl-", "barium borate", "BaB2O4"),
    material("crystal/BGO", "main/Bi4Ge3O12/nk/Williams", "bismuth germanate", "Bi4Ge3O12"),
    material(
        "crystal/CaF2",
        "main/CaF2/nk/Daimon-20",
        "fluorite",
        "calcium fluoride",
        source="Daimon and Masumura, Appl. Opt. 41, 5275 (2002), 20 °C",
    ),
    *axes("crystal/calcite", "main/CaCO3/nk/Ghosh-", "Iceland spar", "CaCO3"),
    *axes("crystal/CaWO4", "main/CaWO4/nk/Bond-", "scheelite"),
    material("crystal/CsI", "main/CsI/nk/Li", "cesium iodide"),
    *axes("crystal/GaN", "main/GaN/nk/Barker-", "gallium nitride", rest=""),
    material("crystal/ice", "main/H2O/nk/Warren-2008"),
    material("crystal/KBr", "main/KBr/nk/Li", "potassium bromide"),
    material("crystal/KCl", "main/KCl/nk/Li", "sylvite", "potassium chloride"),
    *axes("crystal/KDP", "main/KH2PO4/nk/Zernike-", "KH2PO4"),
    material("crystal/KI", "main/KI/nk/Li", "potassium iodide"),
    material("crystal/LiF", "main/LiF/nk/Li", "lithium fluoride"),
    *axes("crystal/LiNbO3", "main/LiNbO3/nk/Zelmon-", "lithium niobate"),
    *axes("crystal/LiTaO3", "main/LiTaO3/nk/Bond-", "lithium tantalate"),
    material("crystal/LuAG", "main/Lu3Al5O12/nk/Hrabovsky", "Lu3Al5O12"),
    *axes("crystal/MgF2", "main/MgF2/nk/Dodge-", "magnesium fluoride"),
    material("crystal/MgO", "main/MgO/nk/Stephens", "periclase", "magnesium oxide"),
    material("crystal/NaCl", "main/NaCl/nk/Li", "salt", "rock salt", "halite"),
    material("crystal/NaF", "main/NaF/nk/Li", "sodium fluoride"),
    material("crystal/PbF2", "main/PbF2/nk/Malitson", "lead fluoride", source=LEAD_FLUORIDE),
    *axes("crystal/quartz", "main/SiO2/nk/Ghosh-", "rock crystal"),
    material("crystal/SrF2", "main/SrF2/nk/Li", "strontium fluoride"),
    *axes("crystal/TeO2", "main/TeO2/nk/Uchida-", "paratellurite"),
    material(
        "crystal/TGG",
        "main/Tb3Ga5O12/nk/Schlarb",
        "Tb3Ga5O12",
        source="Schlarb and Sugg, Phys. Status Solidi B 182 (1994)",
    ),
    material("crystal/Y2O3", "main/Y2O3/nk/Nigara", "yttria"),
    *axes("crystal/YVO4", "main/YVO4/nk/Birnbaum-", "yttrium vanadate"),
    *axes("crystal/ZnO", "main/ZnO/nk/Bond-", "zincite", "zinc oxide"),
    material("crystal/ZnS", "main/ZnS/nk/Debenham", "sphalerite", "zinc sulfide"),
    material("crystal/ZnSe", "main/ZnSe/nk/Marple", "zinc selenide"),
    material("gas/air", "other/mixed gases/air/nk/Ciddor"),
    material("gas/argon", "main/Ar/nk/Peck-15C", "Ar"),
    material("gas/carbon dioxide", "main/CO2/nk/Bideau-Mehu", "CO2"),
    material("gas/helium", "main/He/nk/Borzsonyi", "He"),
    material("gas/hydrogen", "main/H2/nk/Peck", "H2"),
    material("gas/krypton", "main/Kr/nk/Borzsonyi", "Kr"),
    material("gas/neon", "main/Ne/nk/Borzsonyi", "Ne"),
    material("gas/nitrogen", "main/N2/nk/Peck-15C", "N2"),
    material("gas/xenon", "main/Xe/nk/Borzsonyi", "Xe"),
    *axes("gem/chrysoberyl", "main/BeAl2O4/nk/Walling-", "alexandrite", "BeAl2O4", first="x", rest="yz"),
    material("gem/cubic zirconia", "other/mixed crystals/ZrO2-Y2O3/nk/Wood", "zirconia", "ZrO2"),
    material("gem/diamond", "main/C/nk/Peter", source="Peter, Zeitschrift für Physik 15, 358 (1923)"),
    *axes("gem/moissanite", "main/SiC/nk/Wang-4H-", "silicon carbide", "SiC"),
    *axes("gem/rutile", "main/TiO2/nk/Devore-", "TiO2"),
    material("gem/sapphire", "main/Al2O3/nk/Malitson-o", "sapphire-o", "corundum", "Al2O3", source=SAPPHIRE),
    material("gem/sapphire-e", "main/Al2O3/nk/Malitson-e", source=SAPPHIRE.replace("ordinary", "extraordinary")),
    material(
        "gem/spinel",
        "main/MgAl2O4/nk/Tropf",
        "MgAl2O4",
        source="Tropf and Thomas, Handbook of Optical Constants of Solids II (1991)",
    ),
    material("gem/strontium titanate", "main/SrTiO3/nk/Bond", "SrTiO3"),
    material("gem/YAG", "main/Y3Al5O12/nk/Zelmon", "Y3Al5O12"),
    material(
        "glass/fused silica",
        "main/SiO2/nk/Malitson",
        "silica",
        "SiO2",
        source="Malitson, J. Opt. Soc. Am. 55, 1205 (1965)",
    ),
    material("glass/germania", "main/GeO2/nk/Fleming", "GeO2"),
    material("glass/soda-lime", "glass/misc/soda-lime/nk/Rubin-clear", "soda-lime glass", "window glass"),
    material("glass/soda-lime bronze", "glass/misc/soda-lime/nk/Rubin-bronze"),
    material("glass/soda-lime green", "glass/misc/soda-lime/nk/Rubin-green"),
    material("glass/soda-lime grey", "glass/misc/soda-lime/nk/Rubin-grey"),
    material("glass/soda-lime low-iron", "glass/misc/soda-lime/nk/Rubin-lowiron"),
    material("glass/ZBLAN", "glass/misc/ZBLAN/nk/Gan"),
    material("liquid/acetic acid", "organic/C2H4O2 - acetic acid/nk/El-Kashef"),
    material("liquid/acetone", "organic/C3H6O - acetone/nk/Rheims"),
    material("liquid/acetonitrile", "organic/C2H3N - acetonitrile/nk/Moutzouris"),
    material("liquid/benzene", "organic/C6H6 - benzene/nk/Moutzouris"),
    material("liquid/biodiesel", "other/fuel/biodisel/nk/Wang-20C"),
    material("liquid/blood", "other/human body/blood/nk/Liu"),
    material("liquid/butanol", "organic/C4H10O - butanol/nk/Moutzouris-n"),
    material("liquid/carbon disulfide", "main/CS2/nk/Chemnitz", "CS2"),
    material("liquid/carbon tetrachloride", "organic/CCl4 - carbon tetrachloride/nk/Moutzouris", "CCl4"),
    material("liquid/chloroform", "organic/CHCl3 - chloroform/nk/Chang"),
    material("liquid/cyclohexane", "organic/C6H12 - cyclohexane/nk/Rheims"),
    material("liquid/dimethyl sulfoxide", "organic/C2H6OS - dimethyl sulfoxide/nk/Li", "DMSO"),
    material("liquid/dioxane", "organic/C4H8O2 - dioxane/nk/Moutzouris"),
    material("liquid/ethanol", "organic/C2H6O - ethanol/nk/Rheims", "alcohol"),
    material("liquid/ethyl acetate", "organic/C4H8O2 - ethyl acetate/nk/Li"),
    material("liquid/ethyl cinnamate", "organic/C11H12O2 - ethyl cinnamate/nk/Krauter"),
    material("liquid/ethylene glycol", "organic/C2H6O2 - ethylene glycol/nk/El-Kashef", "antifreeze"),
    material(
        "liquid/glycerol",
        "organic/C3H8O3 - glycerol/nk/Gupta",
        "glycerin",
        source="Gupta et al., Adv. Photonics Res. (2022)",
    ),
    material("liquid/heavy water", "main/D2O/nk/Kedenburg", "D2O"),
    material("liquid/heptane", "organic/C7H16 - heptane/nk/Kerl-293K"),
    material("liquid/hexane", "organic/C6H14 - hexane/nk/Kerl-293K"),
    material("liquid/isopropanol", "organic/C3H8O - propanol/nk/Sani-formula"),
    material("liquid/methanol", "organic/CH4O - methanol/nk/Moutzouris"),
    material("liquid/nitrobenzene", "organic/C6H5NO2 - nitrobenzene/nk/Chang"),
    material("liquid/octane", "organic/C8H18 - octane/nk/Kerl-293K"),
    material("liquid/octanol", "organic/C8H18O - octanol/nk/Chang"),
    material("liquid/oleic acid", "organic/C18H34O2 - oleic acid/nk/Jones"),
    material("liquid/pentane", "organic/C5H12 - pentane/nk/Kerl-293K"),
    material("liquid/perfluorohexane", "organic/C6F14 - perfluorohexane/nk/Chang"),
    material("liquid/propanol", "organic/C3H8O - propanol/nk/Moutzouris"),
    material("liquid/pyridine", "organic/C5H5N - pyridine/nk/Chang"),
    material("liquid/styrene", "organic/C8H8 - styrene/nk/Sultanova"),
    material("liquid/tetrahydrofuran", "organic/C4H8O - tetrahydrofuran/nk/Li"),
    material("liquid/toluene", "organic/C7H8 - toluene/nk/Moutzouris"),
    material("liquid/water", "main/H2O/nk/Daimon-20.0C", "H2O", source=WATER, absorption="main/H2O/nk/Hale"),
    material("liquid/xylene", "organic/C8H10 - xylene/nk/Chang"),
    material("plastic/cellulose", "organic/(C6H10O5)n - cellulose/nk/Sultanova"),
    material("plastic/NAS-21", "other/commercial polymers/NAS-21/nk/Sultanova"),
    material("plastic/NOA-61", "other/optical adhesives/NOA-61/nk/Norland", "optical adhesive"),
    material("plastic/Optorez 1330", "other/commercial polymers/Optorez1330/nk/Sultanova"),
    material("plastic/PDMS", "organic/(C2H6OSi)n - polydimethylsiloxane/nk/Schneider-Sylgard184", "silicone"),
    material("plastic/PET", "organic/(C10H8O4)n - polyethylene terephthalate/nk/Zhang"),
    material("plastic/PMMA", "organic/(C5H8O2)n - poly(methyl methacrylate)/nk/Beadie", "acrylic", "plexiglass"),
    material("plastic/polycarbonate", "organic/(C16H14O3)n - polycarbonate/nk/Sultanova"),
    material("plastic/polyetherimide", "organic/(C37H24O6N2)n - polyetherimide/nk/Zhang"),
    material("plastic/polystyrene", "organic/(C8H8)n - polystyrene/nk/Sultanova"),
    material("plastic/polyvinyl alcohol", "organic/(C2H4O)n - polyvinyl alcohol/nk/Schnepf"),
    material("plastic/PVC", "organic/(C2H3Cl)n - polyvinyl chloride/nk/Zhang"),
    material("plastic/SAN", "other/mixed organic/(C8H8)n-(C3H3N)m/nk/Sultanova"),
    material("plastic/Zeonex E48R", "other/commercial polymers/ZeonexE48R/nk/Sultanova"),
]

NOBLE = "Johnson and Christy, Phys. Rev. B 6, 4370 (1972)"
TRANSITION = "Johnson and Christy, Phys. Rev. B 9, 5056 (1974)"

# A page by Werner covers Ta in visible light, but electron energy loss tells too little there: its data makes Ta, Pt
# and Mo as bright as silver.
METALS = [
    material("Ag", "main/Ag/nk/Johnson", "silver", source=NOBLE),
    material("Al", "main/Al/nk/Rakic", "aluminum", "aluminium", source="Rakić, Appl. Opt. 34, 4755 (1995)"),
    material("Au", "main/Au/nk/Johnson", "gold", source=NOBLE),
    *(
        material(f"Au{gold}Ag{100 - gold}", f"other/alloys/Au-Ag/nk/Rioux-Au{gold}Ag{100 - gold}", *names)
        for gold, names in [(20, ()), (40, ()), (50, ("electrum",)), (60, ()), (80, ())]
    ),
    material("AuAl2", "other/intermetallics/AuAl2/nk/Chen", "purple gold"),
    material("Be", "main/Be/nk/Rakic-BB", "beryllium"),
    material("Bi", "main/Bi/nk/Hagemann", "bismuth"),
    material("brass", "other/alloys/Cu-Zn/nk/Querry-Cu70Zn30", "Cu70Zn30"),
    material("Ca", "main/Ca/nk/Mathewson", "calcium"),
    material("Co", "main/Co/nk/Johnson", "cobalt", source=TRANSITION),
    material("Cr", "main/Cr/nk/Johnson", "chromium", "chrome", source=TRANSITION),
    material("Cs", "main/Cs/nk/Smith", "cesium"),
    material("Cu", "main/Cu/nk/Johnson", "copper", source=NOBLE),
    material("Fe", "main/Fe/nk/Johnson", "iron", source=TRANSITION),
    material("Ge", "main/Ge/nk/Aspnes", "germanium"),
    material("gilding metal", "other/alloys/Cu-Zn/nk/Querry-Cu90Zn10", "Cu90Zn10"),
    material("Hf", "main/Hf/nk/Windt", "hafnium"),
    material("Hg", "main/Hg/nk/Inagaki", "mercury"),
    material("In", "main/In/nk/Mathewson-298K", "indium"),
    material("Ir", "main/Ir/nk/Schmitt-MS", "iridium"),
    material("K", "main/K/nk/Smith", "potassium"),
    material("Li", "main/Li/nk/Mathewson-298K", "lithium"),
    material("Mg", "main/Mg/nk/Palm", "magnesium"),
    material("Mn", "main/Mn/nk/Johnson", "manganese", source=TRANSITION),
    material("Mo", "main/Mo/nk/Kirillova", "molybdenum"),
    material("Na", "main/Na/nk/Inagaki", "sodium"),
    material("Nb", "main/Nb/nk/Weaver", "niobium"),
    material("Ni", "main/Ni/nk/Johnson", "nickel", source=TRANSITION),
    material("Os", "main/Os/nk/Nemoshkalenko-o", "osmium"),
    material("Pb", "main/Pb/nk/Mathewson-298K", "lead"),
    material("Pd", "main/Pd/nk/Johnson", "palladium", source=TRANSITION),
    material("permalloy", "other/alloys/Ni-Fe/nk/Tikuisis_bare150nm"),
    material("Pt", "main/Pt/nk/Rakic-BB", "platinum"),
    material("PtAl2", "other/intermetallics/PtAl2/nk/Chen"),
    material("Rb", "main/Rb/nk/Smith", "rubidium"),
    material("Re", "main/Re/nk/Windt", "rhenium"),
    material("red brass", "other/alloys/Cu-Zn/nk/Querry-Cu85Zn15", "Cu85Zn15"),
    material("Rh", "main/Rh/nk/Weaver", "rhodium"),
    material("Ru", "main/Ru/nk/Windt", "ruthenium"),
    material("Si", "main/Si/nk/Aspnes", "silicon"),
    material("Sn", "main/Sn/nk/Golovashkin-293K", "tin"),
    material("stainless steel", "other/alloys/stainless steel/nk/Karlsson-austenitic", "steel", "austenitic steel"),
    material("stainless steel ferritic", "other/alloys/stainless steel/nk/Karlsson-ferritic", "ferritic steel"),
    material("Ta", "main/Ta/nk/Ordal", "tantalum"),
    material("Ti", "main/Ti/nk/Johnson", "titanium", source=TRANSITION),
    material("TiN", "main/TiN/nk/Beliaev-sputtering", "titanium nitride"),
    material("V", "main/V/nk/Johnson", "vanadium", source=TRANSITION),
    material("W", "main/W/nk/Weaver", "tungsten", "wolfram"),
    material("Zn", "main/Zn/nk/Querry", "zinc"),
    material("Zr", "main/Zr/nk/Querry", "zirconium"),
]
