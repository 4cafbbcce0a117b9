"""The force density of closed surfaces by spherical harmonics, in numpy."""


class Harmonics:
    """The force density of a surface given at the nodes of a Gauss-Legendre grid, by spherical harmonics
    of degree p: derivatives of positions and of H in both angles are exact for their expansions.

    Nodes have the colatitudes t of the p + 1 Gauss-Legendre points in cos t, and 2p + 2 longitudes.
    Associated Legendre functions follow from their recurrence (Abramowitz and Stegun 8.5, normalised).
    """

    def __init__(self, np, degree):
        self.np, self.degree = np, degree
        nodes, weights = np.polynomial.legendre.leggauss(degree + 1)
        self.cos, self.weights = nodes, weights
        self.sin = np.sqrt(1 - nodes**2)
        count = degree + 1
        values = np.zeros((count, count, count))  # order m, degree l, node
        values[0, 0] = np.sqrt(0.5)
        for m in range(1, count):
            values[m, m] = np.sqrt((2 * m + 1) / (2 * m)) * self.sin * values[m - 1, m - 1]
        for m in range(count):
            if m + 1 < count:
                values[m, m + 1] = np.sqrt(2 * m + 3) * nodes * values[m, m]
            for l in range(m + 2, count):
                scale = np.sqrt((4 * l * l - 1) / (l * l - m * m))
                back = np.sqrt(((l - 1) ** 2 - m * m) / (4 * (l - 1) ** 2 - 1))
                values[m, l] = scale * (nodes * values[m, l - 1] - back * values[m, l - 2])
        m = np.arange(count)[:, None, None]
        l = np.arange(count)[None, :, None]
        before = np.concatenate([np.zeros((count, 1, count)), values[:, :-1]], axis=1)
        part = np.sqrt(np.maximum((2 * l + 1) * (l * l - m * m) / np.maximum(2 * l - 1, 1), 0))
        first = np.where(l >= m, (l * nodes * values - part * before) / self.sin, 0)
        # Legendre's equation.
        second = -nodes / self.sin * first - (l * (l + 1) - m * m / self.sin**2) * values
        self.forward = values * weights
        self.basis = [np.swapaxes(part, 1, 2).copy() for part in (values, first, second)]
        self.orders = np.arange(count)

    def derivatives(self, fields):
        """u, u_t, u_p, u_tt, u_tp, u_pp of fields at the nodes, a matrix each, stacked."""
        np, count = self.np, self.degree + 1
        waves = np.fft.rfft(fields, axis=-1)[..., :count]
        # Order, degree, field.
        coefficients = self.forward @ np.transpose(waves, (2, 1, 0))
        zero, one, two = (basis @ coefficients for basis in self.basis)
        turn = 1j * self.orders[:, None, None]
        all_ = np.stack([zero, one, turn * zero, two, turn * one, turn * turn * zero])
        padded = np.zeros((6, fields.shape[0], count, count + 1), complex)
        padded[..., :count] = np.transpose(all_, (0, 3, 2, 1))
        return np.fft.irfft(padded, 2 * count, axis=-1)

    def force(self, positions):
        """H and f = 2 (Delta H + 2 H (H^2 - K)) along the normal, κ = 1, of x, y and z at the nodes; and
        the weights of the nodes by area."""
        np = self.np
        _, x_t, x_p, x_tt, x_tp, x_pp = self.derivatives(positions)
        dot = lambda a, b: (a * b).sum(axis=0)
        e, f, g = dot(x_t, x_t), dot(x_t, x_p), dot(x_p, x_p)
        cross = np.cross(x_t, x_p, axis=0)
        square = e * g - f * f
        normal = cross / np.sqrt(square)
        # Of second derivatives along the outward normal, so that H of a sphere is positive.
        l, m, n = (-dot(second, normal) for second in (x_tt, x_tp, x_pp))
        mean = 0.5 * (e * n - 2 * f * m + g * l) / square
        gaussian = (l * n - m * m) / square
        _, h_t, h_p, h_tt, h_tp, h_pp = self.derivatives(mean[None])[:, 0]
        inverse = (g / square, -f / square, e / square)
        # The gradient of H is h_t and h_p raised; its product with x_ab is what Christoffel symbols do.
        up_t = inverse[0] * h_t + inverse[1] * h_p
        up_p = inverse[1] * h_t + inverse[2] * h_p
        gradient = up_t * x_t + up_p * x_p
        laplacian = (
            inverse[0] * (h_tt - dot(x_tt, gradient))
            + 2 * inverse[1] * (h_tp - dot(x_tp, gradient))
            + inverse[2] * (h_pp - dot(x_pp, gradient))
        )
        force = 2 * (laplacian + 2 * mean * (mean**2 - gaussian))
        return force, np.sqrt(square) / self.sin[:, None] * self.weights[:, None]


def exact_discocyte(np, cos, longitudes):
    """Positions and f of the discocyte of Evans and Fung (1972), z = ±(R/2) √(1 − u) P(u), as the image of
    the unit sphere; the formulas of the core's `shapes::Discocyte`."""
    c0, c1, c2 = 0.207161, 2.002558, -1.122762
    z = cos[:, None] + 0 * longitudes
    r = np.sqrt(1 - z * z)
    x, y = r * np.cos(longitudes), r * np.sin(longitudes)
    u, v = r * r, z * z
    thickness, slope, bend = c0 + u * (c1 + u * c2), c1 + 2 * c2 * u, 2 * c2
    q = v * slope - thickness / 2, v * bend - 1.5 * slope, -2.5 * bend
    g = v + u * q[0] ** 2, q[0] ** 2 + 2 * u * q[0] * q[1] - 1, 2 * (
        2 * q[0] * q[1] + u * (q[1] ** 2 + q[0] * q[2])
    )
    m = (
        q[0] + 2 * u * v * q[1],
        q[1] + 2 * ((v - u) * q[1] + u * v * q[2]),
        q[2] + 4 * ((v - u) * q[2] - q[1]),
    )
    n = (
        q[0] * g[0] + m[0],
        q[1] * g[0] + q[0] * g[1] + m[1],
        q[2] * g[0] + 2 * q[1] * g[1] + q[0] * g[2] + m[2],
    )
    steep = n[1] * g[0] - 1.5 * n[0] * g[1]
    bent = n[2] * g[0] - 0.5 * n[1] * g[1] - 1.5 * n[0] * g[2]
    flux = (steep + u * bent) * g[0] - 3 * u * steep * g[1]
    laplacian = -(2 * v * flux - u * steep * g[0]) * g[0] ** -4.5
    mean, gaussian = -0.5 * n[0] * g[0] ** -1.5, q[0] * m[0] / g[0] ** 2
    force = 2 * (laplacian + 2 * mean * (mean**2 - gaussian))
    return np.stack([x, y, z * thickness / 2]), force
