//! The same backward Euler step in double precision, solved monolithically: thread nodes and tissue points in one dense Newton
//! iteration on the incremental energy, to convergence. Written from the equations, sharing no code with the module.

type V = [f64; 3];

fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn norm(a: V) -> f64 {
    (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt()
}

/// Gaussian elimination with partial pivoting.
pub(super) fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            if factor != 0.0 {
                let (top, bottom) = a.split_at_mut(i);
                for (x, y) in bottom[0][k..].iter_mut().zip(&top[k][k..]) {
                    *x -= factor * y;
                }
                b[i] -= factor * b[k];
            }
        }
    }
    for k in (0..n).rev() {
        for j in k + 1..n {
            b[k] -= a[k][j] * b[j];
        }
        b[k] /= a[k][k];
    }
    b
}

/// −gradient and Hessian of the incremental energy.
struct System {
    force: Vec<f64>,
    hessian: Vec<Vec<f64>>,
}

impl System {
    fn spring(&mut self, i: usize, k: f64, d: V) {
        for (r, d) in d.iter().enumerate() {
            self.force[3 * i + r] -= k * d;
            self.hessian[3 * i + r][3 * i + r] += k;
        }
    }

    fn joint(&mut self, joint: &Joint) {
        for &(i, share) in &joint.parts {
            for (r, sum) in joint.sum.iter().enumerate() {
                self.force[3 * i + r] -= joint.k * share * sum;
                for &(j, other) in &joint.parts {
                    self.hessian[3 * i + r][3 * j + r] += joint.k * share * other;
                }
            }
        }
    }

    fn turn(&mut self, a: usize, b: usize, block: &[V; 3]) {
        for (r, row) in block.iter().enumerate() {
            for (c, bend) in row.iter().enumerate() {
                self.hessian[3 * a + r][3 * a + c] += bend;
                self.hessian[3 * b + r][3 * b + c] += bend;
                self.hessian[3 * a + r][3 * b + c] -= bend;
                self.hessian[3 * b + r][3 * a + c] -= bend;
            }
        }
    }
}

/// What bends: ½ k |Σ share·place − less|².
struct Joint {
    k: f64,
    /// Nodes with their shares.
    parts: Vec<(usize, f64)>,
    sum: V,
}

impl Joint {
    fn new(k: f64, parts: &[(usize, f64)], x: &[V], less: V) -> Self {
        let total = |r: usize| parts.iter().map(|(i, share)| share * x[*i][r]).sum::<f64>();
        Self {
            k,
            parts: parts.to_vec(),
            sum: sub([0, 1, 2].map(total), less),
        }
    }
}

/// Thread nodes 0…n−2, then tail, then eyelets, the first the nearest to the tail.
#[derive(Clone)]
pub(super) struct Monolith {
    pub(super) links: usize,
    pub(super) rest: f64,
    pub(super) axial: f64,
    pub(super) density: f64,
    pub(super) alpha: f64,
    pub(super) coupling: f64,
    /// EI, with which links push too, and the direction in which the thread leaves the swage; nothing for a thread that does not bend.
    pub(super) bending: Option<(f64, V)>,
    pub(super) tissue_mass: f64,
    pub(super) tissue_stiffness: f64,
    pub(super) tissue_rest: Vec<V>,
    /// The links through the eyelets.
    pub(super) through: Vec<usize>,
    pub(super) x: Vec<V>,
    pub(super) v: Vec<V>,
}

impl Monolith {
    /// m (1 + α dt)/dt² and where the point coasts to, of m(v⁺ − v)/dt = f − α m v⁺; the tissue's points have no α.
    fn inertia(&self, i: usize) -> (f64, V) {
        let (mass, alpha) = match i {
            0 => (0.5 * self.density * self.rest, self.alpha),
            i if i >= self.links => (self.tissue_mass, 0.0),
            _ => (self.density * self.rest, self.alpha),
        };
        let damped = 1.0 + alpha * 1e-3;
        let coast = [0, 1, 2].map(|r| self.x[i][r] + 1e-3 / damped * self.v[i][r]);
        (mass * damped / 1e-6, coast)
    }

    /// Pairs of points whose distances add to the length of link k.
    fn legs(&self, k: usize) -> Vec<(usize, usize)> {
        let eyelets = self.through.iter().enumerate().rev().filter(|(_, link)| **link == k);
        let inner = eyelets.map(|(j, _)| self.links + 1 + j);
        let points: Vec<usize> = [k].into_iter().chain(inner).chain([k + 1]).collect();
        points.windows(2).map(|pair| (pair[0], pair[1])).collect()
    }

    fn elongation(&self, x: &[V], k: usize) -> f64 {
        self.legs(k).iter().map(|(a, b)| norm(sub(x[*a], x[*b]))).sum::<f64>() - self.rest
    }

    /// Springs to fixed places: inertia, tissue, the swage. (point, stiffness, from the place)
    fn springs(&self, x: &[V], swage: V) -> Vec<(usize, f64, V)> {
        let mut all = vec![(0, self.coupling, sub(x[0], swage))];
        for (i, rest) in self.tissue_rest.iter().enumerate() {
            all.push((self.links + i, self.tissue_stiffness, sub(x[self.links + i], *rest)));
        }
        all.extend(x.iter().enumerate().map(|(i, p)| {
            let (m, coast) = self.inertia(i);
            (i, m, sub(*p, coast))
        }));
        all
    }

    /// The joints of three nodes, and the clamp.
    fn joints(&self, x: &[V]) -> Vec<Joint> {
        let Some((bending, heading)) = self.bending else {
            return Vec::new();
        };
        let k = bending / self.rest.powi(3);
        let free = |link: usize| !self.through.contains(&link);
        let inner = (1..self.links).filter(|i| free(i - 1) && free(*i));
        let joint = |i: usize| Joint::new(k, &[(i - 1, 1.0), (i, -2.0), (i + 1, 1.0)], x, [0.0; 3]);
        let mut all: Vec<_> = inner.map(joint).collect();
        if free(0) {
            let way = heading.map(|h| h * self.rest);
            all.push(Joint::new(2.0 * k, &[(0, -1.0), (1, 1.0)], x, way));
        }
        all
    }

    /// Whether link k holds its length against pushing.
    fn pushes(&self, k: usize) -> bool {
        self.bending.is_some() && !self.through.contains(&k)
    }

    fn energy(&self, x: &[V], swage: V) -> f64 {
        let springs: f64 = self
            .springs(x, swage)
            .iter()
            .map(|(_, k, d)| 0.5 * k * norm(*d).powi(2))
            .sum();
        let joints = self.joints(x);
        let bent: f64 = joints.iter().map(|joint| 0.5 * joint.k * norm(joint.sum).powi(2)).sum();
        let taut = (0..self.links).map(|k| match self.elongation(x, k) {
            pushed if pushed < 0.0 && !self.pushes(k) => 0.0,
            elongation => elongation.powi(2),
        });
        springs + bent + 0.5 * self.axial / self.rest * taut.sum::<f64>()
    }

    fn linearise(&self, x: &[V], swage: V) -> System {
        let n = 3 * x.len();
        let mut system = System {
            force: vec![0.0; n],
            hessian: vec![vec![0.0; n]; n],
        };
        for (i, k, d) in self.springs(x, swage) {
            system.spring(i, k, d);
        }
        for joint in self.joints(x) {
            system.joint(&joint);
        }
        let stiffness = self.axial / self.rest;
        for k in 0..self.links {
            let tension = stiffness * self.elongation(x, k);
            if tension <= 0.0 && !self.pushes(k) {
                continue;
            }
            let mut gradient = vec![0.0; n];
            for (a, b) in self.legs(k) {
                let d = sub(x[a], x[b]);
                let l = norm(d);
                for r in 0..3 {
                    gradient[3 * a + r] += d[r] / l;
                    gradient[3 * b + r] -= d[r] / l;
                }
                let unit = |r: usize, c: usize| if r == c { 1.0 } else { 0.0 };
                // Newton's iteration needs a matrix that is positive definite; the solution is where the forces balance.
                let block =
                    [0, 1, 2].map(|r| [0, 1, 2].map(|c| tension.abs() / l * (unit(r, c) - d[r] * d[c] / (l * l))));
                system.turn(a, b, &block);
            }
            let touched: Vec<usize> = (0..n).filter(|i| gradient[*i] != 0.0).collect();
            for &i in &touched {
                system.force[i] -= tension * gradient[i];
                for &j in &touched {
                    system.hessian[i][j] += stiffness * gradient[i] * gradient[j];
                }
            }
        }
        system
    }

    /// Force and stiffness at the tissue's points with every node eliminated, where the points now are.
    pub(super) fn condensed(&self, swage: V) -> (Vec<f64>, Vec<Vec<f64>>) {
        let System { force, hessian } = self.linearise(&self.x, swage);
        let inner = 3 * self.links;
        let block: Vec<Vec<f64>> = hessian[..inner].iter().map(|row| row[..inner].to_vec()).collect();
        let alone = solve(block.clone(), force[..inner].to_vec());
        let dot = |row: &[f64], x: &[f64]| row.iter().zip(x).map(|(a, b)| a * b).sum::<f64>();
        let outer = inner..force.len();
        let left = outer
            .clone()
            .map(|r| force[r] - dot(&hessian[r][..inner], &alone))
            .collect();
        let column = |c: usize| solve(block.clone(), hessian[..inner].iter().map(|row| row[c]).collect());
        let columns: Vec<Vec<f64>> = outer.clone().map(column).collect();
        let row = |r: usize| {
            outer
                .clone()
                .zip(&columns)
                .map(|(c, x)| hessian[r][c] - dot(&hessian[r][..inner], x))
                .collect()
        };
        (left, outer.clone().map(row).collect())
    }

    /// Newton's iteration with backtracking; the solution and the largest force left over.
    fn converge(&self, start: Vec<V>, swage: V) -> (Vec<V>, f64) {
        let mut x = start;
        let mut left = f64::INFINITY;
        for _ in 0..100 {
            let System { force, hessian } = self.linearise(&x, swage);
            left = force.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            if left < 1e-10 {
                break;
            }
            let slope_step = solve(hessian, force.clone());
            let slope: f64 = slope_step.iter().zip(&force).map(|(s, g)| s * g).sum();
            let before = self.energy(&x, swage);
            let mut scale = 1.0;
            loop {
                let step = |(i, p): (usize, &V)| [0, 1, 2].map(|r| p[r] + scale * slope_step[3 * i + r]);
                let trial: Vec<V> = x.iter().enumerate().map(step).collect();
                if self.energy(&trial, swage) <= before - 1e-4 * scale * slope + 1e-18 || scale < 1e-6 {
                    x = trial;
                    break;
                }
                scale *= 0.5;
            }
        }
        (x, left)
    }

    /// One tick. Of the links that could be in the eyelets those with the least energy are: a frictionless thread slides
    /// to them. For each choice the energy is convex, so where the iteration begins has no part in the result; `near` is a place and
    /// links from which it converges. Gives the force of the thread on the swage and the largest force left over.
    pub(super) fn tick(&mut self, swage: V, near: (Vec<usize>, Vec<V>)) -> (V, f64) {
        let (at, near) = near;
        let mut candidates = vec![Vec::new()];
        for k in &self.through {
            let around = k.saturating_sub(1)..=(k + 1).min(self.links - 1);
            let longer = |old: &Vec<usize>| {
                around
                    .clone()
                    .map(|link| [old.clone(), vec![link]].concat())
                    .collect::<Vec<_>>()
            };
            candidates = candidates.iter().flat_map(longer).collect();
        }
        let tried = candidates
            .into_iter()
            .filter(|links| links.is_sorted_by(|a, b| a >= b))
            .map(|through| {
                let start = if through == at { near.clone() } else { self.x.clone() };
                let trial = Self {
                    through,
                    ..self.clone()
                };
                let (x, left) = trial.converge(start, swage);
                (trial.energy(&x, swage), trial.through, x, left)
            });
        let (_, through, x, left) = tried.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        let velocity = |(new, old): (&V, &V)| sub(*new, *old).map(|d| d / 1e-3);
        self.v = x.iter().zip(&self.x).map(velocity).collect();
        self.x = x;
        self.through = through;
        ([0, 1, 2].map(|r| self.coupling * (self.x[0][r] - swage[r])), left)
    }
}
