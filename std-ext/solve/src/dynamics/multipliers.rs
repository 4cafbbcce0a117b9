//! Multipliers of gradients that are not orthogonal.

use helfrich::constraint::least_squared_sine;

/// The λ for which `Σ λ_i g_i` is nearest to a field, by Gram–Schmidt; none for a gradient that
/// depends on those before it, by the limit for the number of vertices in [`least_squared_sine`], and is left out; 0
/// for one that vanishes.
pub fn multipliers(
    gradients: &[Vec<f64>],
    field: &[f64],
    vertices: usize,
    dot: impl Fn(&[f64], &[f64]) -> f64,
) -> Vec<Option<f64>> {
    let least: f64 = least_squared_sine(vertices);
    // Each orthogonal vector, with its coefficients in terms of the gradients.
    let mut basis: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    let mut multipliers = vec![0.0; gradients.len()];
    let mut is_dependent = vec![false; gradients.len()];
    for (index, gradient) in gradients.iter().enumerate() {
        let mut own = gradient.clone();
        let mut made = vec![0.0; gradients.len()];
        made[index] = 1.0;
        for (other, other_made) in &basis {
            let part = dot(gradient, other) / dot(other, other);
            for (own, other) in own.iter_mut().zip(other) {
                *own -= part * other;
            }
            for (made, other) in made.iter_mut().zip(other_made) {
                *made -= part * other;
            }
        }
        let [size, all] = [dot(&own, &own), dot(gradient, gradient)];
        if size > least * all {
            let part = dot(field, &own) / size;
            for (multiplier, made) in multipliers.iter_mut().zip(&made) {
                *multiplier += part * made;
            }
            basis.push((own, made));
        } else {
            is_dependent[index] = all > 0.0;
        }
    }
    let found = multipliers.into_iter().zip(is_dependent);
    found
        .map(|(multiplier, is_dependent)| (!is_dependent).then_some(multiplier))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::multipliers;

    #[test]
    fn a_combination_is_taken_apart_and_a_repeated_gradient_left_out() {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let gradients = [vec![1.0, 1.0, 0.0], vec![0.0, 1.0, 2.0]];
        // 3 g₁ − 2 g₂ and something orthogonal to both.
        let field = [3.0 + 2.0, 1.0 - 2.0, -4.0 + 1.0];
        let found = multipliers(&gradients, &field, 1000, dot);
        let found = Vec::from_iter(found.into_iter().flatten());
        assert!((found[0] - 3.0).abs() < 1e-14, "{found:?}");
        assert!((found[1] + 2.0).abs() < 1e-14, "{found:?}");

        let twice = [gradients[0].clone(), vec![2.0, 2.001, 0.0]];
        let found = multipliers(&twice, &[3.0, 3.0, 0.0], 1000, dot);
        assert_eq!(found, [Some(3.0), None]);
        let none = [gradients[0].clone(), vec![0.0; 3]];
        let found = multipliers(&none, &[3.0, 3.0, 0.0], 1000, dot);
        assert_eq!(found, [Some(3.0), Some(0.0)]);
    }
}
