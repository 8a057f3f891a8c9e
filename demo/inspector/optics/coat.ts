import type { LocalEnvironment } from './environment-light'
import { fresnel } from './fresnel'
import type { Colour } from './light-spectrum'
import type { Direction } from './orders'

/** A clear lacquer; directions are in a frame whose third axis is its normal. */
export interface Coat {
  /** Share of the surface that it covers, 0 to 1. */
  share: number
  ior: number
  /** Slope parameter of GGX: the square of three's roughness. */
  alpha: number
}

/** Below, the highlight of a point is smaller than a pixel; the shaders' lobe of a light is no narrower either. */
const LEAST_ALPHA = 0.0025
/** Parts of the lobe along its two uniform numbers, the radius' and the turn's. */
const [RINGS, SECTORS] = [32, 64] as const
/** A light's disc is followed to so many standard deviations, in so many parts along either axis. */
const [REACH, PARTS] = [4, 24] as const

/** Share of light that passes the lacquer once. */
export function coatPassing({ share, ior }: Coat, cosine: number): number {
  return 1 - share * fresnel(Math.min(Math.max(cosine, 0), 1), ior)
}

/**
 * Radiance from a light over its irradiance on a plane that faces it, 1/sr: GGX with the height-correlated Smith term
 * (Heitz 2014), averaged over the light's Gaussian disc.
 *
 * @param angularRadius - the disc's standard deviation, rad
 */
export function coatHighlight(
  coat: Coat,
  wi: Direction,
  wo: Direction,
  angularRadius: number,
): number {
  if (wi[2] <= 0 || wo[2] <= 0) return 0
  if (angularRadius === 0)
    return reflected({ ...coat, alpha: Math.max(coat.alpha, LEAST_ALPHA) }, wi, wo)
  let sum = 0
  if (2 * coat.alpha < angularRadius) {
    // The lobe is the narrower of both: what of the disc lies in it.
    const density = 1 / (2 * Math.PI * angularRadius ** 2)
    alongLobe(coat, wo, (x, y, z, share) => {
      const cosine = x * wi[0] + y * wi[1] + z * wi[2]
      // 1 − cos of the angle, with the digits of small ones.
      const away2 = (x - wi[0]) ** 2 + (y - wi[1]) ** 2 + (z - wi[2]) ** 2
      if (cosine > 0) sum += share * density * Math.exp(-away2 / (2 * angularRadius ** 2))
    })
    return sum
  }
  const [right, up] = perpendicular(wi)
  let total = 0
  for (let i = 0; i < PARTS; i++)
    for (let j = 0; j < PARTS; j++) {
      const [a, b] = [i, j].map((k) => REACH * ((2 * k + 1) / PARTS - 1)) as [number, number]
      const share = Math.exp(-0.5 * (a * a + b * b))
      const moved = [0, 1, 2].map(
        (c) => wi[c]! + angularRadius * (a * right[c]! + b * up[c]!),
      ) as unknown as Direction
      const length = Math.hypot(...moved)
      total += share
      sum += share * reflected(coat, moved.map((x) => x / length) as unknown as Direction, wo)
    }
  return sum / total
}

/** Radiance of the environment in the lacquer, linear sRGB: what its whole lobe reflects. environment: in that frame. */
export function coatMirror(coat: Coat, wo: Direction, environment: LocalEnvironment): Colour {
  const sum = new Float64Array(3)
  if (wo[2] > 0)
    alongLobe(coat, wo, (x, y, z, share) => {
      environment.add(x, y, z, share, sum, 0)
    })
  return Array.from(sum) as Colour
}

/** f_r cosθ_i of the lacquer, 1/sr. */
function reflected({ share, ior, alpha }: Coat, wi: Direction, wo: Direction): number {
  if (wi[2] <= 0 || wo[2] <= 0) return 0
  const h = [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]] as const
  const length = Math.hypot(...h)
  const cosH = h[2] / length
  const a2 = alpha ** 2
  // 1 − cos²(1 − a²) with the digits of small angles.
  const slope = (h[0] ** 2 + h[1] ** 2) / length ** 2 + a2 * cosH ** 2
  const distribution = a2 / (Math.PI * slope ** 2)
  const smith = (one: number, other: number): number =>
    one * Math.sqrt(a2 + (1 - a2) * other * other)
  const visibility = 0.5 / (smith(wo[2], wi[2]) + smith(wi[2], wo[2]))
  const cosine = (wi[0] * h[0] + wi[1] * h[1] + wi[2] * h[2]) / length
  return share * fresnel(Math.min(cosine, 1), ior) * distribution * visibility * wi[2]
}

/**
 * Visits directions that make up the lobe, with the share of the radiance from each that is reflected to the viewer: evenly
 * over the normals that the viewer sees (Heitz 2018, "Sampling the GGX distribution of visible normals").
 */
function alongLobe(
  { share, ior, alpha }: Coat,
  wo: Direction,
  visit: (x: number, y: number, z: number, share: number) => void,
): void {
  if (alpha === 0) {
    visit(-wo[0], -wo[1], wo[2], share * fresnel(wo[2], ior))
    return
  }
  const length = Math.hypot(alpha * wo[0], alpha * wo[1], wo[2])
  const [vx, vy, vz] = [(alpha * wo[0]) / length, (alpha * wo[1]) / length, wo[2] / length]
  const flat = Math.hypot(vx, vy)
  const [tx, ty] = flat > 0 ? [-vy / flat, vx / flat] : [1, 0]
  const masking = (cosine: number): number =>
    (Math.sqrt(1 + alpha ** 2 * (1 / cosine ** 2 - 1)) - 1) / 2
  const seen = 1 + masking(wo[2])
  for (let i = 0; i < RINGS; i++) {
    // Finer rings towards the rim, where normals lean without end and what they reflect goes below the horizon.
    const toRim = 1 - (i + 0.5) / RINGS
    const r = Math.sqrt(1 - toRim ** 2)
    const part = (share * 2 * toRim) / (RINGS * SECTORS)
    for (let j = 0; j < SECTORS; j++) {
      // Turned from ring to ring, so that none lie in rows.
      const turn = (2 * Math.PI * (j + ((i * 0.61803) % 1))) / SECTORS
      const a = r * Math.cos(turn)
      const half = (1 + vz) / 2
      const b = (1 - half) * Math.sqrt(1 - a * a) + half * r * Math.sin(turn)
      const c = Math.sqrt(Math.max(1 - a * a - b * b, 0))
      // a T1 + b T2 + c V, T2 = V × T1; then unstretched.
      const x = alpha * (a * tx - b * vz * ty + c * vx)
      const y = alpha * (a * ty + b * vz * tx + c * vy)
      const z = Math.max(b * (vx * ty - vy * tx) + c * vz, 0)
      const norm = Math.hypot(x, y, z)
      const [hx, hy, hz] = [x / norm, y / norm, z / norm]
      const cosine = wo[0] * hx + wo[1] * hy + wo[2] * hz
      const up = 2 * cosine * hz - wo[2]
      if (up <= 0) continue
      visit(
        2 * cosine * hx - wo[0],
        2 * cosine * hy - wo[1],
        up,
        (part * fresnel(Math.min(cosine, 1), ior) * seen) / (seen + masking(up)),
      )
    }
  }
}

/** Two unit vectors at right angles to a third, and to each other. */
function perpendicular([x, y, z]: Direction): [Direction, Direction] {
  const flat = Math.hypot(x, y)
  const right: Direction = flat > 1e-9 ? [-y / flat, x / flat, 0] : [1, 0, 0]
  return [
    right,
    [y * right[2] - z * right[1], z * right[0] - x * right[2], x * right[1] - y * right[0]],
  ]
}
