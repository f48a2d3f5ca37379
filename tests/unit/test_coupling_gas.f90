!> Steps of gas and parcels together: the ledger of momentum in a bed with a flow through it, and a uniform suspension
!> against its own equation, on any number of ranks.
program test_coupling_gas
  use boundary_settings, only: boundary_settings_t
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use coupling_settings, only: coupling_settings_t
  use coupling_scene, only: scene_t, build, add, refill, set_gas, gravity, viscosity, density
  use drag_response, only: drag_t, particles_t, new_drag
  use kinds, only: wp
  use parcels, only: velocity_row, drive_row
  implicit none

  type(communicator_t) :: comm

  call start_ranks(comm)
  call check_bed('gidaspow')
  call check_bed('beetstra')
  call check_suspension(0.02_wp)
  call check_suspension(2.0_wp)
  call check_suspension(100.0_wp)
  call check_free_bed(0.5_wp)
  call check_free_bed(2.0_wp)
  call check_free_bed(20.0_wp)
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> One step of both; the parcels keep their places.
  subroutine advance(scene, dt, converged)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: dt  !< [s]
    logical, intent(out) :: converged

    call scene%coupling%prepare(scene%parcels, scene%gas, dt, as_seen=.true.)
    call scene%gas%advance(dt, converged)
    call scene%gas%accept()
    call scene%coupling%drive(scene%parcels, scene%gas, dt)
    associate (parcels => scene%parcels)
      parcels%state(velocity_row:velocity_row + 2, :parcels%n) = parcels%state(velocity_row:velocity_row + 2, :parcels%n) &
        + dt*parcels%coupled(drive_row:drive_row + 2, :parcels%n)
    end associate
  end subroutine advance

  !> To prepare with the gas as it was seen to drive gives the same as to look at all of it again; the void fraction is seen
  !> anew, and all is where the window is another.
  subroutine check_memory(scene, drag)
    type(scene_t), intent(in) :: scene
    character(len=*), intent(in) :: drag

    type(scene_t) :: anew
    real(wp), allocatable :: coefficient(:,:,:), source(:,:,:,:)
    logical :: alike, other

    anew = scene
    associate (gas => anew%gas, parcels => anew%parcels)
      parcels%weight(:parcels%n) = 0.9_wp*parcels%weight(:parcels%n)
      coefficient = gas%drag
      call anew%coupling%map_void_fraction(parcels, gas)
      call anew%coupling%prepare(parcels, gas, 1.0e-3_wp, as_seen=.true.)
      other = any(abs(gas%drag - coefficient) > 0.01_wp*coefficient)
      coefficient = gas%drag
      source = gas%drag_source
      call anew%coupling%prepare(parcels, gas, 1.0e-3_wp, as_seen=.false.)
      alike = .not. (any(abs(gas%drag - coefficient) > 0.0_wp) .or. any(abs(gas%drag_source - source) > 0.0_wp))
      call anew%coupling%drive(parcels, gas, 1.0e-3_wp)
      call anew%coupling%follow_tiles(anew%tiles, 0.004_wp)  ! wider than before, so nothing is remembered
      call anew%coupling%map_void_fraction(parcels, gas)
      call anew%coupling%prepare(parcels, gas, 1.0e-3_wp, as_seen=.true.)
      alike = alike .and. all(abs(gas%drag - coefficient) <= 0.1_wp*coefficient)
    end associate
    alike = comm%max(merge(0, 1, alike)) == 0
    other = comm%max(merge(1, 0, other)) == 1
    if (comm%is_root()) call expect(alike .and. other, 'the gas is remembered, the void fraction seen anew, '//drag)
  end subroutine check_memory

  !> Air through a random bed in the lower half of a box: what the parcels get is what the gas loses, every step.
  subroutine check_bed(drag)
    character(len=*), intent(in) :: drag

    integer, parameter :: total = 500
    type(scene_t) :: scene
    type(boundary_settings_t) :: records(2)
    real(wp) :: x(3), worst, force(3), weight, expected_weight
    logical :: converged, all_converged
    integer :: m, i

    call build(comm, 0.03_wp, [6, 12, 6], [.false., .false., .false.], drag, scene)
    records(1)%kind = 'inflow'
    records(1)%lower = [0.0_wp, 0.0_wp, 0.0_wp]
    records(1)%upper = [0.03_wp, 0.0_wp, 0.03_wp]
    records(1)%velocity = 0.3_wp
    records(2)%kind = 'outflow'
    records(2)%lower = [0.0_wp, 0.06_wp, 0.0_wp]
    records(2)%upper = [0.03_wp, 0.06_wp, 0.03_wp]
    call refill(scene, records)
    do m = 1, total
      x = [0.03_wp, 0.03_wp, 0.03_wp]*modulo(m*[0.8191725134_wp, 0.6710436067_wp, 0.5497004779_wp], 1.0_wp)
      call add(scene, x, spread(0.0_wp, 1, 3), 5.0e-4_wp + 1.0e-6_wp*modulo(m, 100), 2500.0_wp, 300.0_wp)
    end do
    worst = 0.0_wp
    all_converged = .true.
    call scene%coupling%map_void_fraction(scene%parcels, scene%gas)
    call scene%gas%accept()
    do i = 1, 4
      call advance(scene, 1.0e-3_wp, converged)
      all_converged = all_converged .and. converged
      worst = max(worst, scene%coupling%exchange%momentum_residual)
    end do
    force = scene%coupling%exchange%drag
    call check_memory(scene, drag)
    weight = comm%sum(sum(-gravity(2)/scene%parcels%state(8, :scene%parcels%n)))
    expected_weight = 9.81_wp*2500*300*pi/6*sum([((5.0e-4_wp + 1.0e-6_wp*modulo(m, 100))**3, m=1, total)])
    call scene%gas%destroy()
    if (.not. comm%is_root()) return
    call expect_close(weight, expected_weight, 1e-12_wp, 'the weight of the bed, '//drag)
    call expect(all_converged, 'the gas converges, '//drag)
    call expect(force(2) > 0.05_wp*weight .and. force(2) < 10*weight, 'the bed is dragged upwards, '//drag)
    call expect_close(worst, 0.0_wp, 1e-12_wp, 'momentum given is momentum taken in every step, '//drag)
  end subroutine check_bed

  !> A suspension of 10 % of 20 um grains falls through a periodic box, its gas first rising at 1 m/s: gas and grains
  !> follow  u' = u - mu X,  v' = v + dt g + X,  X = eps r (u' - v - q (dt g - phi/eps X_before)),  mu the mass of grains
  !> over that of gas: there is no pressure gradient.
  subroutine check_suspension(ratio)
    real(wp), intent(in) :: ratio  !< step over response time in creeping flow

    real(wp), parameter :: d = 2.0e-5_wp, solid_density = 2500.0_wp, solids = 0.1_wp
    type(scene_t) :: scene
    type(boundary_settings_t) :: none(0)
    real(wp) :: dt, error, u, v, x, change, scale, before
    logical :: converged, all_converged
    character(len=80) :: name
    integer :: i

    call build(comm, 0.01_wp, [4, 8, 4], [.true., .true., .true.], 'gidaspow', scene)
    call refill(scene, none)
    call set_gas(scene, [0.0_wp, 1.0_wp, 0.0_wp], spread(0.0_wp, 1, 3))
    call fill_cells(scene, d, solid_density, solids)
    call scene%coupling%map_void_fraction(scene%parcels, scene%gas)
    call scene%gas%accept()
    dt = ratio*solid_density*d**2/(18*viscosity)
    u = 1.0_wp
    v = 0.0_wp
    x = 0.0_wp
    error = 0.0_wp
    all_converged = .true.
    do i = 1, 6
      before = total_momentum(scene)
      call advance(scene, dt, converged)
      all_converged = all_converged .and. converged
      call suspension_step(dt, d, solid_density, solids, u, v, x)
      change = total_momentum(scene) - before
      scale = scene%coupling%exchange%solids_volume*solid_density
      error = max(error, abs(change/scale - gravity(2)*dt)/max(abs(gravity(2)*dt), 1.0_wp))
      error = max(error, velocity_error(scene, u, v)/max(abs(u), abs(v), 1.0_wp))
    end do
    call scene%gas%destroy()
    write (name, '(a,f0.2)') 'a falling suspension, dt/tau = ', ratio
    if (.not. comm%is_root()) return
    call expect(all_converged, trim(name)//', converges')
    call expect_close(error, 0.0_wp, 1e-8_wp, trim(name)//', follows its equation')
    call expect_close(scene%coupling%exchange%momentum_residual, 0.0_wp, 1e-12_wp, trim(name)//', exchange')
  end subroutine check_suspension

  !> Gas is forced through a dense bed of grains that nothing holds, of eps = 0.45: they are carried along, and their slip
  !> settles where drag and its pressure gradient bear their weight, beta w/eps = m g, without ringing at any step.
  subroutine check_free_bed(ratio)
    real(wp), intent(in) :: ratio  !< step over response time in creeping flow

    real(wp), parameter :: d = 7.5e-5_wp, solid_density = 1500.0_wp, solids = 0.55_wp, speed = 0.2_wp
    type(scene_t) :: scene
    type(boundary_settings_t) :: records(2)
    real(wp) :: dt, slip, worst, reynolds, force
    logical :: converged, all_converged
    character(len=80) :: name
    integer :: i

    call build(comm, 0.01_wp, [4, 8, 4], [.true., .false., .true.], 'ergun', scene)
    records(1)%id = 'bottom'
    records(1)%kind = 'inflow'
    records(1)%velocity = speed
    records(1)%lower = 0.0_wp
    records(1)%upper = [0.01_wp, 0.0_wp, 0.01_wp]
    records(2)%id = 'top'
    records(2)%kind = 'outflow'
    records(2)%lower = [0.0_wp, 0.02_wp, 0.0_wp]
    records(2)%upper = [0.01_wp, 0.02_wp, 0.01_wp]
    call refill(scene, records)
    call fill_cells(scene, d, solid_density, solids)
    call scene%coupling%map_void_fraction(scene%parcels, scene%gas)
    call scene%gas%accept()
    dt = ratio*solid_density*d**2/(18*viscosity)*18*(1 - solids)**2/(150*solids)
    all_converged = .true.
    worst = 0.0_wp
    do i = 1, 60
      call advance(scene, dt, converged)
      all_converged = all_converged .and. converged
      if (i > 40) worst = max(worst, scene%coupling%exchange%mean_slip)
    end do
    slip = scene%coupling%exchange%mean_slip
    reynolds = density*(1 - solids)*d*slip/viscosity
    force = 3*pi*viscosity*d*(150*solids + 1.75_wp*reynolds)/(18*(1 - solids)**2)*slip
    call scene%gas%destroy()
    write (name, '(a,f0.2)') 'a free dense bed, dt/tau = ', ratio
    if (.not. comm%is_root()) return
    call expect(all_converged, trim(name)//', converges')
    call expect_close(force/(-gravity(2)*solid_density*pi/6*d**3), 1.0_wp, 5.0e-3_wp, trim(name)//', its slip bears its weight')
    call expect_close(worst/slip, 1.0_wp, 1.0e-3_wp, trim(name)//', and does not swing')
  end subroutine check_free_bed

  !> One parcel in the middle of every cell.
  subroutine fill_cells(scene, d, solid_density, solids)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: d, solid_density, solids  !< [m], [kg/m3], volume fraction

    integer :: i, j, k

    do k = 1, scene%mesh%n(3)
      do j = 1, scene%mesh%n(2)
        do i = 1, scene%mesh%n(1)
          call add(scene, scene%mesh%finest*([i, j, k] - 0.5_wp), spread(0.0_wp, 1, 3), d, solid_density, &
                   solids*product(scene%mesh%finest)/(pi/6*d**3))
        end do
      end do
    end do
  end subroutine fill_cells

  !> Vertical momentum of gas and parcels [kg m/s].
  function total_momentum(scene) result(momentum)
    type(scene_t), intent(in) :: scene
    real(wp) :: momentum

    associate (n => scene%boxes%n, parcels => scene%parcels, gas => scene%gas)
      momentum = sum(parcels%state(velocity_row + 1, :parcels%n)/parcels%state(8, :parcels%n))
      momentum = momentum + density*product(scene%mesh%finest) &
        *sum(gas%eps(1:n(1), 1:n(2), 1:n(3))*gas%velocity(1:n(1), 1:n(2), 1:n(3), 2))
    end associate
    momentum = comm%sum(momentum)
  end function total_momentum

  !> Largest departure of any cell and any parcel from the given vertical velocities [m/s].
  function velocity_error(scene, u, v) result(error)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: u, v
    real(wp) :: error

    associate (n => scene%boxes%n, parcels => scene%parcels, gas => scene%gas)
      error = max(0.0_wp, maxval(abs(gas%velocity(1:n(1), 1:n(2), 1:n(3), 2) - u)))
      if (parcels%n > 0) error = max(error, maxval(abs(parcels%state(velocity_row + 1, :parcels%n) - v)))
    end associate
    error = comm%max(error)
  end function velocity_error

  !> One step of the equation above.
  subroutine suspension_step(dt, d, solid_density, solids, u, v, x)
    real(wp), intent(in) :: dt, d, solid_density, solids
    real(wp), intent(inout) :: u, v, x  !< x: change of v by drag in the last step, and in this one

    type(coupling_settings_t) :: settings
    type(drag_t) :: drag
    type(particles_t) :: grain
    real(wp) :: mass_ratio, r, lead

    drag = new_drag(settings, density, viscosity)
    grain%n = 1
    grain%diameter(1) = d
    grain%inverse_mass(1) = 1/(solid_density*pi/6*d**3)
    grain%eps(1) = 1 - solids
    grain%slip(:, 1) = [0.0_wp, u - v, 0.0_wp]
    grain%acceleration(:, 1) = gravity - [0.0_wp, solids/(1 - solids)*x/dt, 0.0_wp]
    call drag%respond(dt, grain)
    r = grain%coefficient(1)*dt*grain%inverse_mass(1)
    lead = grain%lead(2, 1)
    mass_ratio = solids*solid_density/((1 - solids)*density)
    x = r*(u - v - lead)/(1 + r*mass_ratio)
    u = u - mass_ratio*x
    v = v + dt*gravity(2) + x
  end subroutine suspension_step

end program test_coupling_gas
