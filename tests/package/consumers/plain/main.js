import { drawScene } from '../scene.js'

await drawScene('/node_modules/three-diffraction/maps/baked/')
