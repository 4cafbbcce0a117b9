//! A stroke font made for this program, with geometric letters of one weight.
//!
//! Each glyph is a path on a grid: the baseline is at y = 0, capitals are 14 high, small letters
//! 9.5, descenders end at −4.2. `M x y` lifts the pen, `L x y` draws a line, `C` a cubic Bézier
//! curve (two controls and the end), `A x y rx ry from to` an arc of an ellipse between two angles
//! in degrees, `O x y rx ry` a whole ellipse.

/// Height of the capitals on the grid.
pub(super) const CAPITALS: f64 = 14.0;
/// Distance from the right edge of a glyph to the left edge of the next one.
const SPACING: f64 = 3.4;
/// Size of superscripts and subscripts.
const SCRIPT: f64 = 0.64;

/// A glyph: its width, and its path.
type Glyph = (f64, &'static str);

/// Combining dot above the preceding character, as in γ̇.
const DOT_ABOVE: char = '\u{307}';
/// Distance of the dot from the top of that character.
const DOT_RISE: f64 = 3.0;

/// Box that replaces a character that the font lacks.
const MISSING: Glyph = (8.0, "M 0 0 L 8 0 L 8 14 L 0 14 L 0 0");

/// The glyph of each character; several characters may share one.
#[rustfmt::skip]
const GLYPHS: &[(&str, Glyph)] = &[
    (" ", (3.0, "")),
    ("\u{2009}", (0.0, "")),
    ("0", (8.0, "O 4 7 4 7")),
    ("1", (8.0, "M 1.2 11.2 L 4.7 14 L 4.7 0")),
    ("2", (8.0, "A 4 10 4 4 170 -45 L 0 0 L 8 0")),
    ("3", (8.0, "A 3.9 10.5 3.5 3.5 155 -90 A 3.9 3.5 4.1 3.5 90 -150")),
    ("4", (8.0, "M 6.2 0 L 6.2 14 L 0 4.4 L 8.4 4.4")),
    ("5", (8.0, "M 7.3 14 L 1.3 14 L 0.7 7.7 A 3.7 4.5 4.3 4.5 135 -150")),
    ("6", (8.0, "O 4 4.5 4 4.5 M 0 4.5 C 0 10 2.5 13.8 6.8 13.8")),
    ("7", (8.0, "M 0 14 L 8 14 L 2.8 0")),
    ("8", (8.0, "O 4 10.6 3.4 3.4 O 4 3.6 4 3.6")),
    ("9", (8.0, "O 4 9.5 4 4.5 M 8 9.5 C 8 4 5.5 0.2 1.2 0.2")),
    ("AΑ", (10.0, "M 0 0 L 5 14 L 10 0 M 1.8 5 L 8.2 5")),
    ("B", (8.5, "M 0 0 L 0 14 L 4.5 14 A 4.5 10.7 3.4 3.3 90 -90 L 0 7.4 M 4.5 7.4 A 4.5 3.7 4 3.7 90 -90 L 0 0")),
    ("C", (9.6, "A 5.5 7 5.5 7 45 315")),
    ("D", (9.5, "M 0 0 L 0 14 L 3.5 14 A 3.5 7 6 7 90 -90 L 0 0")),
    ("E", (7.5, "M 7.5 14 L 0 14 L 0 0 L 7.5 0 M 0 7.4 L 6.5 7.4")),
    ("F", (7.2, "M 7.2 14 L 0 14 L 0 0 M 0 7.2 L 6.2 7.2")),
    ("G", (10.4, "A 5.5 7 5.5 7 45 330 L 10.3 6.5 L 6.3 6.5")),
    ("H", (9.5, "M 0 0 L 0 14 M 9.5 0 L 9.5 14 M 0 7.3 L 9.5 7.3")),
    ("I", (1.0, "M 0.5 0 L 0.5 14")),
    ("J", (6.0, "M 6 14 L 6 4 A 3 4 3 4 0 -165")),
    ("K", (8.5, "M 0 0 L 0 14 M 8 14 L 0 5.5 M 3 8.7 L 8.5 0")),
    ("L", (7.0, "M 0 14 L 0 0 L 7 0")),
    ("M", (11.0, "M 0 0 L 0 14 L 5.5 4 L 11 14 L 11 0")),
    ("N", (9.5, "M 0 0 L 0 14 L 9.5 0 L 9.5 14")),
    ("O", (11.0, "O 5.5 7 5.5 7")),
    ("P", (8.0, "M 0 0 L 0 14 L 4.2 14 A 4.2 10.2 3.8 3.8 90 -90 L 0 6.4")),
    ("Q", (11.0, "O 5.5 7 5.5 7 M 6.5 3.5 L 10.5 -0.8")),
    ("R", (8.5, "M 0 0 L 0 14 L 4.2 14 A 4.2 10.2 3.8 3.8 90 -90 L 0 6.4 M 4.2 6.4 L 8.5 0")),
    ("S", (8.5, "A 4.25 10.5 3.8 3.5 30 245 A 4.25 3.5 4.25 3.5 65 -150")),
    ("T", (9.0, "M 0 14 L 9 14 M 4.5 14 L 4.5 0")),
    ("U", (9.5, "M 0 14 L 0 4.75 A 4.75 4.75 4.75 4.75 180 360 L 9.5 14")),
    ("V", (10.0, "M 0 14 L 5 0 L 10 14")),
    ("W", (14.0, "M 0 14 L 3.5 0 L 7 12 L 10.5 0 L 14 14")),
    ("X", (9.0, "M 0 14 L 9 0 M 9 14 L 0 0")),
    ("Y", (9.0, "M 0 14 L 4.5 6.5 L 9 14 M 4.5 6.5 L 4.5 0")),
    ("Z", (8.5, "M 0 14 L 8.5 14 L 0 0 L 8.5 0")),
    ("a", (7.5, "O 3.75 4.75 3.75 4.75 M 7.5 9.5 L 7.5 0")),
    ("b", (7.5, "M 0 14 L 0 0 O 3.75 4.75 3.75 4.75")),
    ("c", (6.8, "A 3.9 4.75 3.9 4.75 45 315")),
    ("d", (7.5, "O 3.75 4.75 3.75 4.75 M 7.5 14 L 7.5 0")),
    ("e", (7.6, "M 0.1 4.9 L 7.6 4.9 A 3.8 4.75 3.8 4.75 2 318")),
    ("f", (4.8, "M 5 13.6 C 3.2 14.4 1.9 13.4 1.9 11.2 L 1.9 0 M 0 9.5 L 4.6 9.5")),
    ("g", (7.5, "O 3.75 4.75 3.75 4.75 M 7.5 9.5 L 7.5 -0.5 A 3.8 -0.5 3.7 3.6 0 -150")),
    ("h", (7.0, "M 0 14 L 0 0 M 0 6 A 3.5 6 3.5 3.5 180 0 L 7 0")),
    ("i", (1.0, "M 0.5 9.5 L 0.5 0 M 0.5 13.2 L 0.5 13.2")),
    ("j", (2.2, "M 2 9.5 L 2 -1.8 A -0.3 -1.8 2.3 2.4 0 -80 M 2 13.2 L 2 13.2")),
    ("k", (6.8, "M 0 14 L 0 0 M 6.3 9.5 L 0 3.7 M 2.3 5.8 L 6.8 0")),
    ("l", (1.0, "M 0.5 14 L 0.5 0")),
    ("m", (11.0, "M 0 9.5 L 0 0 M 0 6.4 A 2.75 6.4 2.75 3.1 180 0 L 5.5 0 M 5.5 6.4 A 8.25 6.4 2.75 3.1 180 0 L 11 0")),
    ("n", (7.0, "M 0 9.5 L 0 0 M 0 6 A 3.5 6 3.5 3.5 180 0 L 7 0")),
    ("o", (7.6, "O 3.8 4.75 3.8 4.75")),
    ("p", (7.5, "M 0 9.5 L 0 -4.2 O 3.75 4.75 3.75 4.75")),
    ("q", (7.5, "M 7.5 9.5 L 7.5 -4.2 O 3.75 4.75 3.75 4.75")),
    ("r", (4.4, "M 0 9.5 L 0 0 M 0 5.2 C 0.3 8 2.2 9.7 4.5 9.3")),
    ("s", (6.2, "A 3.1 7.1 2.8 2.4 30 245 A 3.1 2.4 3.1 2.4 65 -150")),
    ("t", (4.8, "M 1.9 12.8 L 1.9 2.6 C 1.9 0.6 3 -0.3 5 0.3 M 0 9.5 L 4.6 9.5")),
    ("u", (7.0, "M 0 9.5 L 0 3.5 A 3.5 3.5 3.5 3.5 180 360 M 7 9.5 L 7 0")),
    ("v", (7.4, "M 0 9.5 L 3.7 0 L 7.4 9.5")),
    ("w", (11.0, "M 0 9.5 L 2.75 0 L 5.5 8.3 L 8.25 0 L 11 9.5")),
    ("x", (7.0, "M 0 9.5 L 7 0 M 7 9.5 L 0 0")),
    ("y", (7.4, "M 0 9.5 L 3.8 0 M 7.4 9.5 L 3.2 -1.6 C 2.5 -3.5 1.5 -4.2 0 -3.9")),
    ("z", (6.6, "M 0 9.5 L 6.6 9.5 L 0 0 L 6.6 0")),
    ("!", (1.0, "M 0.5 14 L 0.5 4.5 M 0.5 0.3 L 0.5 0.3")),
    ("\"", (3.0, "M 0 14 L 0 10.5 M 3 14 L 3 10.5")),
    ("#", (9.5, "M 2 0 L 4 14 M 6 0 L 8 14 M 0.3 4.5 L 8.8 4.5 M 1 9.5 L 9.5 9.5")),
    ("$", (8.5, "A 4.25 10.5 3.8 3.5 30 245 A 4.25 3.5 4.25 3.5 65 -150 M 4.25 16 L 4.25 -2")),
    ("%", (11.0, "O 2.5 11 2.5 3 O 8.5 3 2.5 3 M 9 14 L 2 0")),
    ("&", (10.0, "M 10 0 L 2.2 10 C 0.8 12 2 14 4.2 14 C 6.8 14 7.5 11 5.5 9.3 L 2.5 7 C -0.5 4.8 0 0 4.2 0 C 7.3 0 9.5 2.6 9.8 6.5")),
    ("'′", (1.0, "M 0.5 14 L 0.5 10.5")),
    ("(", (3.5, "M 3.5 16 C -1 10.5 -1 2 3.5 -3.5")),
    (")", (3.5, "M 0 16 C 4.5 10.5 4.5 2 0 -3.5")),
    ("*", (6.0, "M 3 14 L 3 8 M 0.4 12.5 L 5.6 9.5 M 0.4 9.5 L 5.6 12.5")),
    ("+", (8.0, "M 4 3 L 4 11 M 0 7 L 8 7")),
    (",", (1.4, "M 1 0.3 L 1 0 L 0.2 -2.6")),
    ("-", (4.5, "M 0 5.5 L 4.5 5.5")),
    ("–", (7.0, "M 0 5.5 L 7 5.5")),
    (".", (1.0, "M 0.5 0.3 L 0.5 0.3")),
    ("…", (9.0, "M 0.5 0.3 L 0.5 0.3 M 4.5 0.3 L 4.5 0.3 M 8.5 0.3 L 8.5 0.3")),
    ("/", (6.0, "M 0 -2 L 6 15.5")),
    (":", (1.0, "M 0.5 0.3 L 0.5 0.3 M 0.5 8.5 L 0.5 8.5")),
    (";", (1.4, "M 1 0.3 L 1 0 L 0.2 -2.6 M 1 8.5 L 1 8.5")),
    ("<", (8.0, "M 8 12 L 0 7 L 8 2")),
    ("=", (8.0, "M 0 9 L 8 9 M 0 5 L 8 5")),
    (">", (8.0, "M 0 12 L 8 7 L 0 2")),
    ("?", (7.0, "A 3.5 10.5 3.4 3.5 165 -60 C 4 6.5 3.5 6 3.5 4.3 M 3.5 0.3 L 3.5 0.3")),
    ("@", (13.0, "O 6.5 5.3 2.8 3 M 9.3 8.3 L 9.3 4.5 C 9.3 1.8 13 1.8 13 5.5 C 13 14 0 14 0 5.5 C 0 -2.8 6.5 -3.5 10.5 -1.2")),
    ("[", (3.2, "M 3.2 16 L 0 16 L 0 -3 L 3.2 -3")),
    ("\\", (6.0, "M 0 15.5 L 6 -2")),
    ("]", (3.2, "M 0 16 L 3.2 16 L 3.2 -3 L 0 -3")),
    ("^", (6.0, "M 0 9.5 L 3 14 L 6 9.5")),
    ("_", (7.0, "M 0 -1.6 L 7 -1.6")),
    ("`", (2.5, "M 0 14 L 2.5 11.5")),
    ("{", (4.0, "M 4 16 C 1.2 16 2 13 2 10.5 C 2 8 1.5 6.7 0 6.5 C 1.5 6.3 2 5 2 2.5 C 2 0 1.2 -3 4 -3")),
    ("|", (1.0, "M 0.5 16 L 0.5 -3")),
    ("}", (4.0, "M 0 16 C 2.8 16 2 13 2 10.5 C 2 8 2.5 6.7 4 6.5 C 2.5 6.3 2 5 2 2.5 C 2 0 2.8 -3 0 -3")),
    ("~", (8.0, "M 0 6 C 1.5 9 3 9 4 7 C 5 5 6.5 5 8 8")),
    ("−", (8.0, "M 0 7 L 8 7")),
    ("·", (1.0, "M 0.5 6.2 L 0.5 6.2")),
    ("×", (7.0, "M 0 3.5 L 7 10.5 M 0 10.5 L 7 3.5")),
    ("±", (8.0, "M 4 4.5 L 4 12.5 M 0 8.5 L 8 8.5 M 0 1 L 8 1")),
    ("°", (4.4, "O 2.2 11.8 2.2 2.2")),
    ("α", (9.2, "M 8.8 9.5 C 7.2 4 5.5 0 3.4 0 C 1 0 0 2 0 4.75 C 0 7.5 1.2 9.5 3.6 9.5 C 6.3 9.5 6.8 0 9.2 0")),
    ("β", (7.5, "M 0 -4.2 L 0 10.7 A 3.4 10.7 3.4 3.3 180 -90 A 3.4 3.7 4.1 3.7 90 -150")),
    ("γ", (8.0, "M 0 8.5 C 0.6 9.8 2 9.9 2.7 7.6 L 4.4 1.5 M 8 9.5 L 4.4 1 C 3.6 -1 3 -4.2 4.3 -4.2 C 5.6 -4.2 5.2 -1 4.4 1")),
    ("Γ", (7.0, "M 7 14 L 0 14 L 0 0")),
    ("δ", (7.6, "O 3.8 4.4 3.8 4.4 M 3.6 8.8 C 1.4 10.2 1 12 2.2 13.2 C 3.4 14.3 5.2 14 6.4 13.2")),
    ("Δ∆", (10.0, "M 0 0 L 5 14 L 10 0 L 0 0")),
    ("ε", (6.4, "M 6.2 8.4 C 4.5 10 0.7 10 0.7 7.2 C 0.7 5.4 2 4.9 3.8 4.9 M 3.8 4.9 C 1.5 4.9 0 4.2 0 2.4 C 0 -0.7 4.6 -0.6 6.4 1.1")),
    ("η", (7.0, "M 0 9.5 L 0 0 M 0 6 A 3.5 6 3.5 3.5 180 0 L 7 -4.2")),
    ("θ", (7.6, "O 3.8 7 3.8 7 M 0.2 7 L 7.4 7")),
    ("κ", (6.8, "M 0 9.5 L 0 0 M 6.2 9.5 L 0 3.9 M 2.2 5.8 L 6.8 0")),
    ("λ", (7.6, "M 0 13.8 C 1.6 14.3 2.3 13.2 3 11.2 L 7.6 0 M 4.1 8.2 L 0 0")),
    ("µμ", (7.8, "M 0 9.5 L 0 -4.2 M 0 3.3 A 3.3 3.3 3.3 3.3 180 360 M 6.6 9.5 L 6.6 1.6 C 6.6 0.4 7.2 0 8 0.3")),
    ("ν", (7.2, "M 0 9.5 L 3.5 0 C 5.5 3.5 7 6 7.2 9.5")),
    ("π", (8.6, "M 0 9.5 L 8.6 9.5 M 2.2 9.5 L 2 0 M 6.4 9.5 L 6.4 1.8 C 6.4 0.3 7.2 -0.2 8.6 0.3")),
    ("ρ", (7.5, "M 0 -4.2 L 0 4.75 O 3.75 4.75 3.75 4.75")),
    ("σ", (8.4, "O 3.8 4.6 3.8 4.6 M 3.8 9.2 L 8.4 9.2")),
    ("Σ∑", (8.5, "M 8.5 14 L 0 14 L 5 7.2 L 0 0 L 8.5 0")),
    ("τ", (7.0, "M 0 9.5 L 7 9.5 M 3.5 9.5 L 3.5 2 C 3.5 0.4 4.3 -0.3 6 0.3")),
    ("φ", (8.8, "O 4.4 4.75 4.4 4.75 M 4.4 13 L 4.4 -4.2")),
    ("ψ", (8.8, "M 0 9.5 L 0 6 C 0 2.5 1.5 1 4.4 1 C 7.3 1 8.8 2.5 8.8 6 L 8.8 9.5 M 4.4 13 L 4.4 -4.2")),
    ("ω", (10.5, "M 1.8 9.5 C -0.8 5.5 -0.3 0 2.6 0 C 4.6 0 5.25 2 5.25 5 C 5.25 2 5.9 0 7.9 0 C 10.8 0 11.3 5.5 8.7 9.5")),
    ("Ω", (11.0, "M 0 0 L 3.6 0 L 3.6 1.6 C 1.2 3.2 0 5.5 0 8 C 0 11.6 2.3 14 5.5 14 C 8.7 14 11 11.6 11 8 C 11 5.5 9.8 3.2 7.4 1.6 L 7.4 0 L 11 0")),
    ("∂", (7.0, "M 1.2 13.2 C 4 15 7 12.5 7 7 C 7 2.5 5.8 0 3.3 0 C 1.4 0 0 1.5 0 4 C 0 6.8 1.8 8.4 3.8 8.4 C 5.4 8.4 6.6 7.4 7 5.6")),
    ("∇", (10.0, "M 0 14 L 10 14 L 5 0 L 0 14")),
    ("∫", (6.0, "M 6 15 C 4 16.3 3.2 14.5 3 12 L 2.8 0 C 2.6 -2.8 1.8 -4.4 0 -3.2")),
    ("√", (9.5, "M 0 6 L 1.8 7.2 L 4.2 0 L 7.5 15 L 9.5 15")),
    ("≤", (8.0, "M 8 13 L 0 8.5 L 8 4 M 0 1.5 L 8 1.5")),
    ("≥", (8.0, "M 0 13 L 8 8.5 L 0 4 M 0 1.5 L 8 1.5")),
    ("≈", (8.0, "M 0 8.5 C 1.5 11.5 3 11.5 4 9.5 C 5 7.5 6.5 7.5 8 10.5 M 0 3.5 C 1.5 6.5 3 6.5 4 4.5 C 5 2.5 6.5 2.5 8 5.5")),
    ("∞", (12.0, "M 6 7 C 4 3.5 0 3 0 7 C 0 11 4 10.5 6 7 C 8 3.5 12 3 12 7 C 12 11 8 10.5 6 7")),
    ("→", (10.0, "M 0 7 L 10 7 M 6.5 10.5 L 10 7 L 6.5 3.5")),
];

fn glyph(character: char) -> Option<Glyph> {
    let found = GLYPHS
        .iter()
        .find(|(characters, _)| characters.contains(character));
    found.map(|&(_, glyph)| glyph)
}

/// Base character of a superscript or subscript, and its height above the baseline.
fn script(character: char) -> Option<(char, f64)> {
    const RAISED: f64 = 6.2;
    const LOWERED: f64 = -3.4;
    let digit = |offset: u32| char::from_digit(offset, 10);
    let plain = match character {
        '⁰' => '0',
        '¹' => '1',
        '²' => '2',
        '³' => '3',
        '⁴'..='⁹' => digit(character as u32 - '⁰' as u32)?,
        '⁺' => '+',
        '⁻' => '−',
        'ₐ' => return Some(('a', LOWERED)),
        'ₛ' => return Some(('s', LOWERED)),
        '₀'..='₉' => return Some((digit(character as u32 - '₀' as u32)?, LOWERED)),
        _ => return None,
    };
    Some((plain, RAISED))
}

/// Glyph with its size and its height above the baseline.
fn placed(character: char) -> (Glyph, f64, f64) {
    let (character, size, raised) = match script(character) {
        Some((plain, raised)) => (plain, SCRIPT, raised),
        None => (character, 1.0, 0.0),
    };
    (glyph(character).unwrap_or(MISSING), size, raised)
}

/// Width of a text on the grid.
pub(super) fn width(text: &str) -> f64 {
    let advance = |character| {
        if character == DOT_ABOVE {
            return 0.0;
        }
        let ((width, _), size, _) = placed(character);
        (width + SPACING) * size
    };
    (text.chars().map(advance).sum::<f64>() - SPACING).max(0.0)
}

/// Strokes of a text on the grid, with the left end at x = 0.
pub(super) fn strokes(text: &str) -> Vec<Vec<[f64; 2]>> {
    let mut strokes: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut left = 0.0;
    // Index of the first stroke of the previous character, and x of its middle.
    let mut before = (0, 0.0);
    for character in text.chars() {
        if character == DOT_ABOVE {
            let (first, middle) = before;
            let heights = strokes[first..].iter().flatten().map(|point| point[1]);
            let y = heights.fold(0.0, f64::max) + DOT_RISE;
            strokes.push(vec![[middle, y]; 2]);
            continue;
        }
        let ((width, path), size, raised) = placed(character);
        before = (strokes.len(), left + 0.5 * size * width);
        let place = |[x, y]: [f64; 2]| [left + size * x, raised + size * y];
        strokes.extend(
            outline(path)
                .into_iter()
                .map(|stroke| stroke.into_iter().map(place).collect()),
        );
        left += (width + SPACING) * size;
    }
    strokes
}

/// Converts the path of a glyph to strokes of short lines.
fn outline(path: &str) -> Vec<Vec<[f64; 2]>> {
    let mut strokes: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut pen_is_down = false;
    let mut words = path.split_ascii_whitespace();
    while let Some(command) = words.next() {
        let mut number = || words.next().and_then(|word| word.parse::<f64>().ok());
        let mut numbers = [0.0; 6];
        let count = match command {
            "M" | "L" => 2,
            "O" => 4,
            _ => 6,
        };
        for slot in &mut numbers[..count] {
            *slot = number().unwrap_or(f64::NAN);
        }
        let [x, y, rx, ry, from, to] = numbers;
        if !pen_is_down || matches!(command, "M" | "O") {
            strokes.push(Vec::new());
        }
        // A stroke exists: it was started now, or the pen was already down.
        let Some(stroke) = strokes.last_mut() else {
            break;
        };
        match command {
            "C" => {
                let start = stroke.last().copied().unwrap_or([x, y]);
                stroke.extend(bezier(start, [x, y], [rx, ry], [from, to]));
            }
            "A" => stroke.extend(arc([x, y], [rx, ry], [from, to])),
            "O" => stroke.extend(arc([x, y], [rx, ry], [0.0, 360.0])),
            _ => stroke.push([x, y]),
        }
        pen_is_down = command != "O";
    }
    strokes
}

fn bezier(
    start: [f64; 2],
    first: [f64; 2],
    second: [f64; 2],
    end: [f64; 2],
) -> impl Iterator<Item = [f64; 2]> {
    const PIECES: i32 = 14;
    (1..=PIECES).map(move |piece| {
        let t = f64::from(piece) / f64::from(PIECES);
        let s = 1.0 - t;
        [0, 1].map(|axis| {
            s * s * (s * start[axis] + 3.0 * t * first[axis])
                + t * t * (3.0 * s * second[axis] + t * end[axis])
        })
    })
}

fn arc(
    [x, y]: [f64; 2],
    [rx, ry]: [f64; 2],
    [from, to]: [f64; 2],
) -> impl Iterator<Item = [f64; 2]> {
    let pieces = ((to - from).abs() / 10.0).ceil();
    (0..=pieces as i32).map(move |piece| {
        let angle = (from + (to - from) * f64::from(piece) / pieces).to_radians();
        [x + rx * libm::cos(angle), y + ry * libm::sin(angle)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_glyph_is_a_path_within_its_cell() {
        let all =
            (' '..='~').chain("−·×±°αβγΓδΔεηθκλµνπρσΣτφψωΩ∂∇∫√≤≥≈∞→–…⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻₀₉ₛ".chars());
        for character in all {
            let ((width, path), ..) = placed(character);
            assert!(path != MISSING.1, "{character}");
            assert_eq!(path.is_empty(), character == ' ');
            for stroke in outline(path) {
                assert!(stroke.len() > 1, "{character}");
                for [x, y] in stroke {
                    assert!((-0.6..=width + 0.6).contains(&x), "{character}: x = {x}");
                    assert!((-4.4..=16.5).contains(&y), "{character}: y = {y}");
                }
            }
        }
        assert_eq!(strokes("\u{1f40d}").len(), 1);
    }

    #[test]
    fn a_dot_stands_above_the_letter_before_it() {
        assert_eq!(width("aγ\u{307}t"), width("aγt"));
        let [plain, dotted] = ["aγt", "aγ\u{307}t"].map(strokes);
        let count = |text| strokes(text).len();
        let (dot, letter) = (count("aγ"), count("a")..count("aγ"));
        let top = plain[letter].iter().flatten().map(|point| point[1]);
        let top = top.fold(0.0, f64::max);
        let [x, y] = dotted[dot][0];
        let middle = width("aγ") - 0.5 * width("γ");
        assert!((x - middle).abs() < 1e-9, "{x} and not {middle}");
        assert!(y > top + 1.0 && y < CAPITALS);
        // All other strokes are unchanged. A dot without a preceding character is drawn alone.
        assert_eq!([&dotted[..dot], &dotted[dot + 1..]].concat(), plain);
        assert_eq!(strokes("\u{307}").len(), 1);
    }
}
