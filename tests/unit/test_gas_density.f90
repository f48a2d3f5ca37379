!> An ideal gas against closed forms, and where it must be one of constant density.
program test_gas_density
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use compressible_flows, only: ideal_gas, tube, open_end, atmosphere, specific, atmosphere_error, filled_vessel, sound, &
    bed_error, ergun_error
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas, set_cells, steps, wavy_void, uneven_drag
  use gas_density, only: begin_density
  use grid_axis, only: graded_axis, graded_faces
  use kinds, only: wp
  use outcome, only: outcome_t
  implicit none

  real(wp), parameter :: o = 0.0_wp, edge = 0.01_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  call columns_at_rest()
  call begins_at_rest(.true.)
  call begins_at_rest(.false.)
  call filling()
  call growing()
  call squeezing()
  call waves()
  call faces()
  call bed()
  call grains()
  call between_pressures()
  call hardly_compressible(.false.)
  call hardly_compressible(.true.)
  call undone()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Along each axis; second order.
  subroutine columns_at_rest()
    real(wp) :: error(0:3)
    integer :: axis
    logical :: ok(0:3)

    call atmosphere_error(comm, 2, 32, .false., error(0), ok(0))
    do axis = 1, 3
      call atmosphere_error(comm, axis, 16, axis == 3, error(axis), ok(axis))
    end do
    if (.not. comm%is_root()) return
    call expect(all(ok), 'columns converge')
    call expect_close(error(0), o, 1.0e-4_wp, 'a column at rest')
    call expect_close(maxval(error(1:3)), o, 4.0e-4_wp, 'columns along all axes')
    call expect_close(log(error(2)/error(0))/log(2.0_wp), 2.0_wp, 0.05_wp, 'order of accuracy')
  end subroutine columns_at_rest

  !> With gravity and an uneven void fraction the pressure a run begins with holds the gas at rest.
  subroutine begins_at_rest(open)
    logical, intent(in) :: open

    real(wp), parameter :: g = 1.0e3_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: fastest, lowest, level
    logical :: ok

    scene = tube(2, 1.0_wp, 0.1_wp, 24)
    scene%gravity(2) = -g
    if (open) call open_end(scene, 2, o)
    scene%cells(1) = 4
    call make_gas(comm, scene, gas, outcome)
    call gas%balance()
    call set_cells(gas%boxes, wavy_void, gas%eps)
    call gas%accept()
    ok = steps(gas, 1, 1.0e-4_wp)
    fastest = comm%max(maxval(abs(gas%velocity)))
    lowest = o
    if (all(gas%boxes%lo == 1)) lowest = gas%pressure(1, 1, 1)
    lowest = comm%sum(lowest)
    level = merge(1.0_wp, 0.5_wp, open)
    call gas%destroy()
    if (.not. comm%is_root()) return
    call expect(ok, 'a gas that begins at rest converges')
    call expect_close(fastest, o, 1.0e-8_wp, 'it stays at rest [m/s]')
    call expect_close(atmosphere + lowest, atmosphere*exp(g*(level - 0.5_wp/24)/specific), 1.0e-8_wp, 'its pressure below')
  end subroutine begins_at_rest

  subroutine filling()
    real(wp) :: pressure, mass
    logical :: ok

    call filled_vessel(comm, pressure, mass, ok)
    if (.not. comm%is_root()) return
    call expect(ok, 'a vessel that fills converges')
    call expect_close(pressure, 1.0_wp, 1.0e-9_wp, 'its pressure')
    call expect_close(mass, 1.0_wp, 1.0e-11_wp, 'its mass')
  end subroutine filling

  !> A vessel of few cells into which gas flows at a given velocity U, at the density within: each step multiplies the pressure
  !> by 1/(1 - U dt/L) where it is uniform.
  subroutine growing()
    real(wp), parameter :: speed = 0.04_wp, dt = 0.05_wp
    integer, parameter :: count = 10
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: mass(2)
    logical :: ok

    scene = tube(1, 8*edge, edge, 8)
    scene%numerics%velocity_tolerance = 1.0e-8_wp
    scene%records = [scene%records, record('in', 'inflow', [o, o, o], [o, edge, edge], velocity=speed)]
    call make_gas(comm, scene, gas, outcome)
    mass(1) = total_pressure(gas)
    ok = steps(gas, count, dt)
    mass(2) = total_pressure(gas)
    call gas%destroy()
    if (.not. comm%is_root()) return
    call expect(ok, 'a vessel that fills by volume converges')
    call expect_close(mass(2)/mass(1), (1 - speed*dt/(8*edge))**(-count), 1.0e-6_wp, 'its pressure grows as a power')
  end subroutine growing

  !> Particles that take the room of a closed gas: p eps is kept, in all and everywhere in the end.
  subroutine squeezing()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: before, after, room, spread
    logical :: ok

    scene%cells = [4, 10, 6]
    scene%upper = edge*scene%cells
    scene%settings = ideal_gas(o, atmosphere)
    allocate (scene%records(0))
    call make_gas(comm, scene, gas, outcome)
    before = total_pressure(gas)
    associate (n => gas%boxes%n)
      call set_cells(gas%boxes, wavy_void, gas%eps)
      gas%drag(1:n(1), 1:n(2), 1:n(3)) = 100*gas%volume(1:n(1), 1:n(2), 1:n(3))
      ok = steps(gas, 6, 0.1_wp)
      after = total_pressure(gas)
      room = comm%sum(sum(gas%eps(1:n(1), 1:n(2), 1:n(3))))*edge**3
      spread = comm%max(maxval(abs(gas%pressure(1:n(1), 1:n(2), 1:n(3))*room/before - 1)))
    end associate
    call gas%destroy()
    if (.not. comm%is_root()) return
    call expect(ok, 'a gas that is squeezed converges')
    call expect(room < 0.8_wp*product(scene%upper), 'it has less room')
    call expect_close(after/before, 1.0_wp, 1.0e-6_wp, 'it keeps its mass')
    call expect_close(spread, o, 1.0e-6_wp, 'its pressure rises as its room shrinks')
  end subroutine squeezing

  !> Sum of p_abs eps V over all ranks [J].
  function total_pressure(gas) result(total)
    type(gas_t), intent(in) :: gas
    real(wp) :: total

    associate (n => gas%boxes%n)
      total = comm%sum(sum((gas%ideal%reference + gas%pressure(1:n(1), 1:n(2), 1:n(3))) &
        *gas%eps(1:n(1), 1:n(2), 1:n(3))*gas%volume(1:n(1), 1:n(2), 1:n(3))))
    end associate
  end function total_pressure

  subroutine waves()
    real(wp) :: frequency, worst
    integer :: axis
    logical :: ok

    do axis = 1, 3
      call sound(comm, axis, 16, 60, frequency, worst, ok)
      if (.not. comm%is_root()) cycle
      call expect(ok, 'sound converges')
      call expect_close(worst, o, 2.0e-5_wp, 'sound, as implicit steps have it')
      call expect_close(frequency, 0.5_wp*sqrt(specific), 6.0e-3_wp, 'frequency of sound')
    end do
  end subroutine waves

  subroutine bed()
    real(wp) :: error(0:3)
    integer :: axis, iterations(0:3)
    logical :: ok(0:3)

    call bed_error(comm, 2, 40, error(0), ok(0), iterations(0))
    do axis = 1, 3
      call bed_error(comm, axis, 20, error(axis), ok(axis), iterations(axis))
    end do
    if (.not. comm%is_root()) return
    call expect(all(ok), 'gas in a bed converges')
    call expect_close(error(0), o, 3.0e-4_wp, 'pressure in a bed')
    call expect_close(maxval(error(1:3)), o, 1.0e-3_wp, 'pressure in beds along all axes')
    call expect_close(log(error(2)/error(0))/log(2.0_wp), 2.0_wp, 0.1_wp, 'order of accuracy')
    call expect(maxval(iterations(1:3)) <= 35, 'it takes few iterations')
  end subroutine bed

  !> Where the pressure is linear so are the densities of faces, on graded cells.
  subroutine faces()
    real(wp), parameter :: slope(3) = [1.0e6_wp, -3.0e6_wp, 2.0e6_wp]  !< [Pa/m]
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: worst, expected
    integer :: a, i, j, k, inner(3)

    scene%cells = [6, 8, 4]
    scene%settings = ideal_gas(atmosphere, o)
    scene%axis = [(graded_axis(graded_faces([o, edge], scene%cells(a:a), [3.0_wp]), .false.), a=1, 3)]
    allocate (scene%records(0))
    call make_gas(comm, scene, gas, outcome)
    worst = o
    associate (n => gas%boxes%n, lo => gas%boxes%lo, psi => gas%ideal%compressibility)
      do k = 1, n(3)
        do j = 1, n(2)
          do i = 1, n(1)
            gas%pressure(i, j, k) = dot_product(slope, gas%mesh%in_metres(lo + [i, j, k] - 1.5_wp))
          end do
        end do
      end do
      call gas%halo%exchange(gas%pressure)
      call begin_density(gas, 1.0_wp)
      do a = 1, 3
        inner = n
        if (gas%boxes%at_high(a)) inner(a) = n(a) - 1
        do k = 1, inner(3)
          do j = 1, inner(2)
            do i = 1, inner(1)
              expected = psi*(atmosphere + dot_product(slope, gas%mesh%in_metres(lo + [i, j, k] - 1.5_wp &
                + merge(0.5_wp, o, [1, 2, 3] == a))))
              worst = max(worst, abs(gas%ideal%face(i, j, k, a)/expected - 1))
            end do
          end do
        end do
      end do
    end associate
    worst = comm%max(worst)
    call gas%destroy()
    if (comm%is_root()) call expect_close(worst, o, 1.0e-13_wp, 'densities of faces')
  end subroutine faces

  !> Drag of parcels at the density of their place.
  subroutine grains()
    real(wp) :: error(2)
    integer :: level
    logical :: ok(2)

    do level = 1, 2
      call ergun_error(comm, 20*level, error(level), ok(level))
    end do
    if (.not. comm%is_root()) return
    call expect(all(ok), 'gas in packed grains converges')
    call expect_close(error(2), o, 8.0e-4_wp, 'pressure in packed grains')
    call expect_close(log(error(1)/error(2))/log(2.0_wp), 2.0_wp, 0.2_wp, 'its order')
  end subroutine grains

  !> Gas enters and leaves a bed at given pressures, in either direction: its mass flow is that of p_1^2 - p_2^2.
  subroutine between_pressures()
    real(wp), parameter :: resistance = 1.0e6_wp, eps = 0.5_wp, high = 0.5_wp*atmosphere, length = 0.5_wp
    integer, parameter :: n = 40
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: flow, found, above(3)
    integer :: way
    logical :: ok

    flow = eps**2/specific*((atmosphere + high)**2 - atmosphere**2)/(2*resistance*length)
    do way = 1, 2
      scene = tube(3, length, edge, n)
      above = [edge, edge, o]
      scene%records = [scene%records, record('low', 'outflow', [o, o, o], above, pressure=merge(high, o, way == 1)), &
                       record('high', 'outflow', [o, o, length], scene%upper, pressure=merge(high, o, way == 2))]
      call make_gas(comm, scene, gas, outcome)
      associate (m => gas%boxes%n)
        gas%eps(1:m(1), 1:m(2), 1:m(3)) = eps
        gas%drag(1:m(1), 1:m(2), 1:m(3)) = resistance*gas%volume(1:m(1), 1:m(2), 1:m(3))
        call gas%accept()
        ok = steps(gas, 8, 0.1_wp)
        ok = steps(gas, 8, 10.0_wp) .and. ok
        found = comm%sum(sum(gas%flux(1:m(1), 1:m(2), 1:m(3), 3)))/(n*edge**2)
      end associate
      call gas%destroy()
      if (.not. comm%is_root()) cycle
      call expect(ok, 'gas between two pressures converges')
      call expect_close(found, merge(flow, -flow, way == 1), 1.0e-4_wp, 'its mass flow')
    end do
  end subroutine between_pressures

  !> At a pressure beside which its differences are nothing the gas is the one of constant density, in an open column as in a
  !> periodic box in which a flow is kept.
  subroutine hardly_compressible(kept)
    logical, intent(in) :: kept

    real(wp), parameter :: g(3) = [o, -9.81_wp, o]
    type(scene_t) :: scene
    type(gas_t) :: gas(2)
    type(outcome_t) :: outcome
    real(wp) :: gap(2), drop(2), room(3)
    integer :: law
    logical :: ok

    scene%cells = [6, 12, 4]
    scene%upper = edge*scene%cells
    scene%periodic = kept
    scene%numerics%tolerance = 1.0e-10_wp
    scene%numerics%velocity_tolerance = 1.0e-10_wp
    allocate (scene%records(0))
    room = scene%upper
    if (kept) then
      scene%settings%flow_given = .true.
      scene%settings%mass_flow = [o, 1.0e-3_wp, 2.0e-4_wp]
    else
      scene%gravity = g
      scene%records = [record('in', 'inflow', [o, o, o], [room(1), o, room(3)], velocity=0.3_wp), &
                       record('jet', 'inflow', [o, 3*edge, o], [o, 5*edge, room(3)]), &
                       record('out', 'outflow', [o, room(2), o], room, pressure=10.0_wp)]
      scene%records(2)%mass_flow = 2.0e-4_wp
    end if
    ok = .true.
    do law = 1, 2
      if (law == 2) call harden(scene)
      call make_gas(comm, scene, gas(law), outcome)
      call set_cells(gas(law)%boxes, wavy_void, gas(law)%eps)
      call set_cells(gas(law)%boxes, uneven_drag, gas(law)%drag)
      call gas(law)%accept()
      ok = steps(gas(law), 3, 1.0e-3_wp) .and. ok
      drop(law) = gas(law)%driving%drop(2)
    end do
    associate (n => gas(1)%boxes%n)
      associate (p => gas(1)%pressure(1:n(1), 1:n(2), 1:n(3)), q => gas(2)%pressure(1:n(1), 1:n(2), 1:n(3)))
        gap(1) = comm%max(maxval(abs(q - p)))/comm%max(maxval(abs(p)))
      end associate
      gap(2) = comm%max(maxval(abs(gas(2)%velocity - gas(1)%velocity)))
    end associate
    call gas(1)%destroy()
    call gas(2)%destroy()
    if (.not. comm%is_root()) return
    call expect(ok, 'both gases converge')
    call expect_close(gap(2), o, 1.0e-6_wp, 'hardly compressible, velocity [m/s]')
    if (.not. kept) call expect_close(gap(1), o, 1.0e-6_wp, 'hardly compressible, pressure')
    if (kept) call expect_close(drop(2), drop(1), 1.0e-6_wp, 'hardly compressible, pressure drop [Pa]')
  end subroutine hardly_compressible

  !> The same density at 1e12 Pa.
  subroutine harden(scene)
    type(scene_t), intent(inout) :: scene

    real(wp), parameter :: pressure = 1.0e12_wp, density = 1.2_wp

    associate (hard => ideal_gas(pressure, o))
      scene%settings%density_law = hard%density_law
      scene%settings%temperature = hard%temperature
      scene%settings%molar_mass = hard%molar_mass*density/hard%density
      scene%settings%reference_pressure = pressure
    end associate
  end subroutine harden

  !> A step that fails, and one that is taken back, leave the density that belongs to the pressure.
  subroutine undone()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: gap(3)
    logical :: converged(2)

    scene = tube(1, 20*edge, edge, 20)
    scene%records = [scene%records, record('in', 'inflow', [o, o, o], [o, edge, edge])]
    scene%records(size(scene%records))%mass_flow = 1.0e-5_wp
    call make_gas(comm, scene, gas, outcome)
    call gas%advance(1.0e-3_wp, converged(1))
    gap(1) = growth(gas)
    call gas%reject()
    gap(2) = growth(gas)
    gas%numerics%maximum_iterations = 1
    call gas%advance(1.0e-3_wp, converged(2))
    gap(3) = growth(gas)
    call gas%destroy()
    if (.not. comm%is_root()) return
    call expect(converged(1) .and. .not. converged(2), 'one step converges and one does not')
    call expect(gap(1) > 1.0e-6_wp*scene%settings%density, 'the density grows')
    call expect(.not. gap(2) > o, 'it is undone')
    call expect(.not. gap(3) > o, 'it is as before a step that failed')
  end subroutine undone

  !> Distance of the density from that at the start [kg/m3].
  function growth(gas) result(largest)
    type(gas_t), intent(in) :: gas
    real(wp) :: largest

    associate (n => gas%boxes%n)
      largest = comm%max(maxval(abs(gas%ideal%density(1:n(1), 1:n(2), 1:n(3)) - gas%ideal%compressibility*atmosphere)))
    end associate
  end function growth

end program test_gas_density
