import { StrictMode, Suspense, use, useState } from 'react'
import { createRoot } from 'react-dom/client'
import { addAfterEffect, Canvas, extend, useThree, type ThreeElement } from '@react-three/fiber'
import { DiffractionMaterial, Foil, Grating, HeightField } from 'three-diffraction'
import { disc, skin, sky } from '../scene.js'

extend({ DiffractionMaterial })

declare module '@react-three/fiber' {
  interface ThreeElements {
    diffractionMaterial: ThreeElement<typeof DiffractionMaterial>
  }
}

// Outside of components: one that was suspended is made anew, and must ask for the same promise.
const foil = Foil.load('maps/baked/foil-polygons')
const grating = new Grating(disc)
const relief = new HeightField(skin)
const environment = sky()

const ready = new Set<DiffractionMaterial>()

/** A ref that asks for a frame when the material's tables have come: with frameloop="always" there is one anyway. */
function useReady() {
  const invalidate = useThree((state) => state.invalidate)
  return (material: DiffractionMaterial | null) => {
    void material?.ready.then(() => {
      ready.add(material)
      invalidate()
    })
  }
}

function Disc() {
  return (
    <mesh position-x={-0.8}>
      <circleGeometry args={[0.75, 64]} />
      <diffractionMaterial ref={useReady()} args={[{ surface: grating }]} />
    </mesh>
  )
}

function Skin() {
  return (
    <mesh position-y={0.92}>
      <planeGeometry args={[2.6, 0.2]} />
      <diffractionMaterial ref={useReady()} args={[{ surface: relief }]} />
    </mesh>
  )
}

function Card({ isGold }: { isGold: boolean }) {
  const surface = use(foil)
  return (
    <mesh position-x={0.8}>
      <planeGeometry args={[1.4, 1.4]} />
      <diffractionMaterial
        ref={useReady()}
        args={[{ surface }]}
        roughness={0.01}
        metal={isGold ? 'gold' : 'silver'}
      />
    </mesh>
  )
}

function App() {
  const [step, setStep] = useState(0)
  return (
    <>
      <Canvas
        flat
        frameloop="demand"
        dpr={1}
        gl={{ antialias: false, preserveDrawingBuffer: true }}
        camera={{ fov: 40, near: 0.1, far: 10, position: [0, 0, 3] }}
        onCreated={({ gl }) => Object.assign(window, { renderer: gl })}
      >
        <color attach="background" args={[0x101010]} />
        {step < 2 && (
          <>
            <dataTexture attach="environment" args={environment} needsUpdate />
            <directionalLight
              args={[0xffffff, 0.3]}
              position={[0.2, 0.5, 1]}
              userData={{ angularRadius: 0.02 }}
            />
            <Disc />
            <Skin />
            <Suspense>
              <Card isGold={step === 0} />
            </Suspense>
          </>
        )}
      </Canvas>
      <button
        onClick={() => {
          setStep(step + 1)
        }}
      >
        Next
      </button>
    </>
  )
}

createRoot(document.getElementById('root')!).render(
  <StrictMode>
    <App />
  </StrictMode>,
)

addAfterEffect(() => {
  if (ready.size === 3) document.title = 'drawn'
})
