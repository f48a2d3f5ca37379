!> A domain with gas and parcels for the tests of the coupling, on any number of ranks.
module coupling_scene
  use boundary_settings, only: boundary_settings_t
  use boxes, only: boxes_t, new_boxes
  use communicator, only: communicator_t
  use constants, only: pi
  use coupling, only: coupling_t
  use coupling_settings, only: coupling_settings_t
  use gas, only: gas_t, new_gas
  use gas_numerics, only: gas_numerics_t
  use gas_settings, only: gas_settings_t
  use kinds, only: wp
  use mesh, only: mesh_t, new_uniform_mesh
  use outcome, only: outcome_t
  use parcels, only: parcels_t, velocity_row, mass_row, drive_row
  use tiles, only: tiles_t, new_tiles
  implicit none
  private
  public :: scene_t, build, add, refill, recouple, step, set_gas, gravity, viscosity, density

  real(wp), parameter :: gravity(3) = [0.0_wp, -9.81_wp, 0.0_wp]
  real(wp), parameter :: viscosity = 1.8e-5_wp, density = 1.2_wp

  !> Everything a step of coupling needs.
  type :: scene_t
    type(mesh_t) :: mesh
    type(boxes_t) :: boxes
    type(tiles_t) :: tiles
    type(gas_t) :: gas
    type(parcels_t) :: parcels
    type(coupling_t) :: coupling
  end type scene_t

contains

  !> A domain of edges 1, 2, 1 times `scale` with gas at rest.
  subroutine build(comm, scale, n, periodic, drag, scene, gas_density, polydispersity)
    type(communicator_t), intent(in) :: comm
    real(wp), intent(in) :: scale  !< [m]
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    character(len=*), intent(in) :: drag
    type(scene_t), intent(out) :: scene
    real(wp), intent(in), optional :: gas_density  !< `density` unless given [kg/m3]
    character(len=*), intent(in), optional :: polydispersity  !< 'none' unless given

    type(coupling_settings_t) :: settings
    type(gas_settings_t) :: gas_settings
    type(gas_numerics_t) :: numerics
    type(boundary_settings_t) :: records(0)
    type(outcome_t) :: outcome
    real(wp) :: upper(3)

    upper = scale*[1.0_wp, 2.0_wp, 1.0_wp]
    scene%mesh = new_uniform_mesh(spread(0.0_wp, 1, 3), upper, n, periodic)
    call new_boxes(comm, n, periodic, scene%boxes, outcome)
    scene%tiles = new_tiles(comm, spread(0.0_wp, 1, 3), upper, periodic, scale*[0.17_wp, 0.19_wp, 0.23_wp])
    settings%drag = drag
    if (present(polydispersity)) settings%polydispersity = polydispersity
    gas_settings%density = density
    if (present(gas_density)) gas_settings%density = gas_density
    gas_settings%viscosity = viscosity
    call new_gas(scene%boxes, scene%mesh, gas_settings, records, numerics, scene%gas, outcome)
    if (outcome%failed()) error stop 'coupling_scene: the gas cannot be made'
    call scene%coupling%create(scene%mesh, scene%boxes, settings, gas_settings, gravity)
    call scene%coupling%follow_tiles(scene%tiles, 0.02_wp*scale)
    call scene%parcels%create(.false., .true.)
  end subroutine build

  !> Replace the gas of a scene by one with boundaries and tight tolerances.
  subroutine refill(scene, records, gas_settings)
    type(scene_t), intent(inout) :: scene
    type(boundary_settings_t), intent(in) :: records(:)
    type(gas_settings_t), intent(in), optional :: gas_settings

    type(gas_settings_t) :: settings
    type(gas_numerics_t) :: numerics
    type(outcome_t) :: outcome

    settings%density = density
    if (present(gas_settings)) settings = gas_settings
    settings%viscosity = viscosity
    numerics%tolerance = 1.0e-9_wp
    numerics%velocity_tolerance = 1.0e-10_wp
    numerics%maximum_iterations = 500
    call scene%gas%destroy()
    call new_gas(scene%boxes, scene%mesh, settings, records, numerics, scene%gas, outcome)
    if (outcome%failed()) error stop 'coupling_scene: the gas cannot be made'
  end subroutine refill

  !> Couple the phases of a scene anew, by other settings.
  subroutine recouple(scene, settings, gas_settings)
    type(scene_t), intent(inout) :: scene
    type(coupling_settings_t), intent(in) :: settings
    type(gas_settings_t), intent(in), optional :: gas_settings

    type(gas_settings_t) :: of_gas

    of_gas%density = density
    if (present(gas_settings)) of_gas = gas_settings
    of_gas%viscosity = viscosity
    call scene%coupling%create(scene%mesh, scene%boxes, settings, of_gas, gravity)
    call scene%coupling%follow_tiles(scene%tiles, 0.01_wp*(scene%mesh%upper(2) - scene%mesh%lower(2)))
  end subroutine recouple

  !> Give the gas one velocity within the domain and one pressure gradient.
  subroutine set_gas(scene, velocity, gradient)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: velocity(3)  !< [m/s]
    real(wp), intent(in) :: gradient(3)  !< [Pa/m]

    integer :: a, i, j, k

    associate (gas => scene%gas)
      do a = 1, 3
        gas%velocity(:, :, :, a) = velocity(a)*gas%free(:, :, :, a)
      end do
      do k = -1, scene%boxes%n(3) + 2
        do j = -1, scene%boxes%n(2) + 2
          do i = -1, scene%boxes%n(1) + 2
            gas%pressure(i, j, k) = dot_product(gradient, scene%mesh%finest*(scene%boxes%lo + [i, j, k]))
          end do
        end do
      end do
    end associate
  end subroutine set_gas

  !> Put a parcel into the hands of the rank of its tile, moved a little since.
  subroutine add(scene, position, moved, diameter, solid_density, weight)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: position(3), moved(3)             !< [m]
    real(wp), intent(in) :: diameter, solid_density, weight   !< [m], [kg/m3], [-]

    if (scene%tiles%owner_of(position) /= scene%boxes%comm%rank) return
    associate (parcels => scene%parcels)
      call parcels%reserve(parcels%n + 1)
      parcels%n = parcels%n + 1
      parcels%state(1:3, parcels%n) = position + moved
      parcels%state(velocity_row:velocity_row + 2, parcels%n) = 0.0_wp
      parcels%state(mass_row, parcels%n) = 1.0_wp/(weight*solid_density*pi/6.0_wp*diameter**3)
      parcels%diameter(parcels%n) = diameter
      parcels%weight(parcels%n) = weight
      parcels%id(parcels%n) = parcels%n
    end associate
  end subroutine add

  !> One gas step with a gas that does not change.
  subroutine step(scene, dt)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: dt  !< [s]

    call scene%coupling%map_void_fraction(scene%parcels, scene%gas)
    call scene%coupling%prepare(scene%parcels, scene%gas, dt, as_seen=.false.)
    call scene%coupling%drive(scene%parcels, scene%gas, dt)
    associate (parcels => scene%parcels)
      if (parcels%n > 0) parcels%state(velocity_row:velocity_row + 2, :parcels%n) = &
        parcels%state(velocity_row:velocity_row + 2, :parcels%n) + dt*parcels%coupled(drive_row:drive_row + 2, :parcels%n)
    end associate
  end subroutine step

end module coupling_scene
