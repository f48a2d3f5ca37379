!> Viscosity and stress of eddies smaller than the cells, of velocities that are given.
program test_eddy_stress
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use eddy_flows, only: wavy_axis
  use eddy_viscosity, only: add_turned, find_eddies
  use gas, only: gas_t
  use gas_cases, only: scene_t, make_gas
  use gas_settings, only: make_ideal
  use gas_state, only: find_density
  use kinds, only: wp
  use manufactured, only: flow_t, rho, mu, void
  use mesh, only: unit_step
  use momentum, only: assemble_momentum
  use outcome, only: outcome_t
  use wall_settings, only: wall_settings_t
  implicit none

  real(wp), parameter :: o = 0.0_wp, constant = 0.17_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  call strain(o, 'equal cells')
  call strain(0.3_wp, 'graded cells')
  call density()
  call stress()
  call motion(.true., 'turns as a body')
  call motion(.false., 'swells evenly')
  call uniform()
  call cut_cells()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> A unit cube of cells as wide as 1 + wave cos(2 pi s).
  subroutine cube(n, wave, periodic, gas)
    integer, intent(in) :: n(3)
    real(wp), intent(in) :: wave
    logical, intent(in) :: periodic
    type(gas_t), intent(out) :: gas

    type(scene_t) :: scene
    type(outcome_t) :: outcome
    integer :: a

    scene%cells = n
    scene%periodic = periodic
    scene%axis = [(wavy_axis(n(a), wave, periodic), a=1, 3)]
    scene%settings%density = rho
    scene%settings%viscosity = mu
    scene%settings%turbulence_model = 'smagorinsky'
    scene%settings%smagorinsky_constant = constant
    allocate (scene%records(0))
    call make_gas(comm, scene, gas, outcome)
  end subroutine cube

  !> The centre of a cell of my box, or of its upper face across a.
  pure function place(gas, cell, a) result(x)
    type(gas_t), intent(in) :: gas
    integer, intent(in) :: cell(3)
    integer, intent(in), optional :: a
    real(wp) :: x(4)

    real(wp) :: s(3)

    s = gas%boxes%lo + cell - 1.5_wp
    if (present(a)) s(a) = s(a) + 0.5_wp
    x = [gas%mesh%in_metres(s), o]
  end function place

  !> Velocities and void fractions of a manufactured flow.
  subroutine set_flow(flow, gas)
    type(flow_t), intent(in) :: flow
    type(gas_t), intent(inout) :: gas

    integer :: a, i, j, k

    do k = 1, gas%boxes%n(3)
      do j = 1, gas%boxes%n(2)
        do i = 1, gas%boxes%n(1)
          gas%eps(i, j, k) = flow%field(void, place(gas, [i, j, k]))
          do a = 1, 3
            gas%velocity(i, j, k, a) = flow%field(a, place(gas, [i, j, k], a))
          end do
        end do
      end do
    end do
    call gas%accept()
    call gas%halo%exchange_many(gas%velocity)
  end subroutine set_flow

  !> mu_t against that of the exact strain at the middles of cells, root mean square.
  subroutine strain(wave, name)
    real(wp), intent(in) :: wave
    character(len=*), intent(in) :: name

    type(flow_t) :: flow
    type(gas_t) :: gas
    real(wp) :: error(2), sums(2), exact
    integer :: level, i, j, k, n

    flow%flat = .false.
    do level = 1, 2
      n = 8*2**level
      call cube([n, n, n], wave, .true., gas)
      call set_flow(flow, gas)
      call find_eddies(gas)
      sums = o
      do k = 1, gas%boxes%n(3)
        do j = 1, gas%boxes%n(2)
          do i = 1, gas%boxes%n(1)
            exact = rho*constant**2*gas%volume(i, j, k)**(2.0_wp/3.0_wp)*sqrt(2*sum(flow%strain(place(gas, [i, j, k]))**2))
            sums = sums + [(mu*(gas%eddies%eps(i, j, k)/gas%eps(i, j, k) - 1) - exact)**2, exact**2]
          end do
        end do
      end do
      sums = comm%sum(sums)
      error(level) = sqrt(sums(1)/sums(2))
      call gas%destroy()
    end do
    if (.not. comm%is_root()) return
    call expect_close(error(2), o, 1.2e-2_wp, 'viscosity on '//name)
    call expect(log(error(1)/error(2))/log(2.0_wp) > 1.8_wp, 'its second order')
  end subroutine strain

  !> Of an ideal gas whose pressure doubles across the box: mu_t is as its density at each place.
  subroutine density()
    type(scene_t) :: scene
    type(gas_t) :: gas(2)
    type(outcome_t) :: outcome
    real(wp) :: worst
    integer :: m, i

    scene%cells = [8, 4, 4]
    scene%periodic = .true.
    scene%settings%turbulence_model = 'smagorinsky'
    allocate (scene%records(0))
    do m = 1, 2
      if (m == 2) then
        scene%settings%molar_mass = 0.03_wp
        scene%settings%temperature = 300.0_wp
        scene%settings%reference_pressure = 1.0e5_wp
        call make_ideal(scene%settings)
      end if
      call make_gas(comm, scene, gas(m), outcome)
      call set_flow(flow_t(flat=.false.), gas(m))
    end do
    do i = 1, gas(2)%boxes%n(1)
      gas(2)%pressure(i, :, :) = 1.0e5_wp*(gas(2)%boxes%lo(1) + i - 1)/8
    end do
    call find_density(gas(2))
    worst = o
    do m = 1, 2
      call find_eddies(gas(m))
    end do
    associate (n => gas(1)%boxes%n)
      do i = 1, n(1)
        worst = max(worst, maxval(abs((gas(2)%eddies%eps(i, 1:n(2), 1:n(3))/gas(2)%eps(i, 1:n(2), 1:n(3)) - 1) &
          /(gas(1)%eddies%eps(i, 1:n(2), 1:n(3))/gas(1)%eps(i, 1:n(2), 1:n(3)) - 1) &
          *gas(1)%density/(scene%settings%density*(1 + (gas(2)%boxes%lo(1) + i - 1)/8.0_wp)) - 1)))
      end do
    end associate
    worst = comm%max(worst)
    do m = 1, 2
      call gas(m)%destroy()
    end do
    if (comm%is_root()) call expect_close(worst, o, 1.0e-10_wp, 'viscosity of an ideal gas is as its density')
  end subroutine density

  !> Both parts of the stress together against the exact force per volume.
  subroutine stress()
    type(flow_t) :: flow
    type(gas_t) :: gas
    real(wp), allocatable :: force(:,:,:)
    real(wp) :: sums(2), error(2), exact(3)
    integer :: level, a, i, j, k, n

    flow%flat = .false.
    do level = 1, 2
      n = 8*2**level
      flow%mixing = 0.02_wp
      call cube([n, n, n], o, .true., gas)
      gas%eddies%constant = flow%mixing*n
      call set_flow(flow, gas)
      call find_eddies(gas)
      sums = o
      do a = 1, 3
        call viscous_force(gas, a, force)
        do k = 1, gas%boxes%n(3), 3
          do j = 1, gas%boxes%n(2), 3
            do i = 1, gas%boxes%n(1), 3
              exact = flow%eddy_force(place(gas, [i, j, k], a))
              exact(a) = exact(a) + flow%viscous_force(a, place(gas, [i, j, k], a))
              sums = sums + [(force(i, j, k)*n**3 - exact(a))**2, exact(a)**2]
            end do
          end do
        end do
      end do
      sums = comm%sum(sums)
      error(level) = sqrt(sums(1)/sums(2))
      call gas%destroy()
    end do
    if (.not. comm%is_root()) return
    call expect_close(error(2), o, 6.0e-3_wp, 'viscous force')
    call expect(log(error(1)/error(2))/log(2.0_wp) > 1.8_wp, 'its second order')
  end subroutine stress

  !> What viscosity does to component a, from the rows of a gas without flux, inertia and pressure [N].
  subroutine viscous_force(gas, a, force)
    type(gas_t), intent(inout) :: gas
    integer, intent(in) :: a
    real(wp), allocatable, intent(out) :: force(:,:,:)  !< (0:n1,0:n2,0:n3), of faces that are solved for

    integer :: b, i, j, k, s(3), x(3), y(3)
    real(wp) :: sums(2)

    gas%flux = o
    gas%fixed = o
    gas%source = o
    gas%pressure = o
    do b = 1, 3
      where (gas%free(:, :, :, b) <= o) gas%fixed(:, :, :, b) = 1.0_wp
    end do
    call reserve_walls(gas)
    call add_turned(gas, a)
    call assemble_momentum(gas, sums)
    associate (st => gas%stencil(a), n => gas%boxes%n, u => gas%velocity)
      allocate (force(0:n(1), 0:n(2), 0:n(3)), source=o)
      do k = st%lo(3), n(3)
        do j = st%lo(2), n(2)
          do i = st%lo(1), n(1)
            if (.not. gas%free(i, j, k, a) > o) cycle
            force(i, j, k) = st%rhs(i, j, k)
            do b = 1, 3
              s = unit_step(b)
              x = [i, j, k] - s
              y = [i, j, k] + s
              force(i, j, k) = force(i, j, k) + st%low(i, b, j, k)*(u(x(1), x(2), x(3), a) - u(i, j, k, a)) &
                + st%high(i, b, j, k)*(u(y(1), y(2), y(3), a) - u(i, j, k, a))
            end do
          end do
        end do
      end do
    end associate
  end subroutine viscous_force

  !> Conductances of walls, which these rows do not have.
  subroutine reserve_walls(gas)
    type(gas_t), intent(inout) :: gas

    integer :: a, b, end, lo(3), hi(3)

    do a = 1, 3
      do b = 1, 3
        do end = 1, 2
          if (a == b .or. .not. gas%boundary%side(end, b)%mine) cycle
          lo = gas%first(:, a)
          hi = gas%boxes%n
          if (end == 1) hi(b) = lo(b)
          if (end == 2) lo(b) = hi(b)
          if (allocated(gas%wall(end, b, a)%conductance)) deallocate (gas%wall(end, b, a)%conductance)
          allocate (gas%wall(end, b, a)%conductance(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)), source=o)
        end do
      end do
    end do
  end subroutine reserve_walls

  !> A gas that turns as a body, or swells evenly, in the cells and faces off the surface: no eddies, and whatever their
  !> viscosity no force.
  subroutine motion(turning, name)
    logical, intent(in) :: turning
    character(len=*), intent(in) :: name

    real(wp), parameter :: spin(3) = [1.0_wp, -2.0_wp, 0.5_wp]
    type(gas_t) :: gas
    real(wp), allocatable :: force(:,:,:)
    real(wp) :: worst(2), x(4), u(3)
    integer :: a, i, j, k, cell(3)

    call cube([8, 10, 6], 0.3_wp, .false., gas)
    do k = -1, gas%boxes%n(3) + 2
      do j = -1, gas%boxes%n(2) + 2
        do i = -1, gas%boxes%n(1) + 2
          do a = 1, 3
            x = place(gas, [i, j, k], a)
            u = [spin(2)*x(3) - spin(3)*x(2), spin(3)*x(1) - spin(1)*x(3), spin(1)*x(2) - spin(2)*x(1)]
            if (.not. turning) u = norm2(spin)*x(:3)
            gas%velocity(i, j, k, a) = u(a)
          end do
        end do
      end do
    end do
    call find_eddies(gas)
    worst = o
    do k = 1, gas%boxes%n(3)
      do j = 1, gas%boxes%n(2)
        do i = 1, gas%boxes%n(1)
          cell = gas%boxes%lo + [i, j, k] - 1
          if (any(cell == 1 .or. cell == gas%mesh%n)) cycle
          worst(1) = max(worst(1), gas%eddies%eps(i, j, k) - 1)
        end do
      end do
    end do
    call set_uneven(gas, 40.0_wp)
    do a = 1, 3
      call viscous_force(gas, a, force)
      do k = 1, gas%boxes%n(3)
        do j = 1, gas%boxes%n(2)
          do i = 1, gas%boxes%n(1)
            cell = gas%boxes%lo + [i, j, k] - 1
            if (any(cell == 1 .or. cell >= gas%mesh%n - 1)) cycle
            worst(2) = max(worst(2), abs(force(i, j, k)))
          end do
        end do
      end do
    end do
    worst(2) = worst(2)/(40*mu*norm2(spin)/100)  ! over a stress times the face of a cell
    worst = comm%max(worst)
    call gas%destroy()
    if (.not. comm%is_root()) return
    call expect_close(worst(1), o, 1.0e-12_wp, 'a gas that '//name//' has no eddies')
    call expect_close(worst(2), o, 1.0e-12_wp, 'and no stress')
  end subroutine motion

  !> eps (1 + mu_t/mu) that varies from cell to cell by what is given, beyond the surface as in the program.
  subroutine set_uneven(gas, size)
    type(gas_t), intent(inout) :: gas
    real(wp), intent(in) :: size

    integer :: i, j, k, cell(3)

    do k = -1, gas%boxes%n(3) + 2
      do j = -1, gas%boxes%n(2) + 2
        do i = -1, gas%boxes%n(1) + 2
          cell = gas%boxes%lo + [i, j, k] - 1
          gas%eddies%eps(i, j, k) = gas%eps(i, j, k)*(50 + size*sin(1.3_wp*cell(1) + 2.1_wp*cell(2) + 0.7_wp*cell(3)))
        end do
      end do
    end do
  end subroutine set_uneven

  !> Velocities that make no volume, also those that come in and go out: where the viscosity is the same everywhere the part
  !> besides the Laplacian vanishes. Where it is not it does not.
  subroutine uniform()
    type(gas_t) :: gas
    real(wp) :: most(2), size
    integer :: a, m

    call cube([8, 10, 6], 0.3_wp, .false., gas)
    call curl(gas)
    do m = 1, 2
      size = merge(o, 40.0_wp, m == 1)
      call set_uneven(gas, size)
      gas%source = o
      do a = 1, 3
        call add_turned(gas, a)
      end do
      most(m) = comm%max(maxval(abs(gas%source)))
    end do
    call gas%destroy()
    if (.not. comm%is_root()) return
    call expect_close(most(1)/most(2), o, 1.0e-13_wp, 'uniform viscosity needs no more than the Laplacian')
  end subroutine uniform

  !> The curl of a vector on the edges of cells, which goes through the surface as well.
  subroutine curl(gas)
    type(gas_t), intent(inout) :: gas

    integer :: a, b, c, i, j, k, s(3), d(3), x(3)

    do a = 1, 3
      b = 1 + modulo(a, 3)
      c = 1 + modulo(a + 1, 3)
      s = unit_step(b)
      d = unit_step(c)
      do k = 0, gas%boxes%n(3) + 1
        do j = 0, gas%boxes%n(2) + 1
          do i = 0, gas%boxes%n(1) + 1
            x = [i, j, k]
            gas%velocity(i, j, k, a) = (stream(gas, x, c) - stream(gas, x - s, c))/gas%spacing(b)%width(x(b)) &
              - (stream(gas, x, b) - stream(gas, x - d, b))/gas%spacing(c)%width(x(c))
          end do
        end do
      end do
    end do
  end subroutine curl

  !> Component c, on the edge along c at the upper end of a cell.
  pure function stream(gas, cell, c) result(psi)
    type(gas_t), intent(in) :: gas
    integer, intent(in) :: cell(3), c
    real(wp) :: psi

    integer :: x(3)

    x = gas%boxes%lo + cell - 1
    psi = sin(1.1_wp*x(1) + 0.6_wp*c)*cos(0.8_wp*x(2) - 0.4_wp*c)*sin(0.9_wp*x(3) + c)
  end function stream

  !> In cells of which a plane leaves 40 % the stress besides the Laplacian acts on 40 % of faces.
  subroutine cut_cells()
    type(scene_t) :: scene
    type(wall_settings_t) :: wall
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: force(2), x(4)
    integer :: i, j, k

    wall%kind = 'plane'
    wall%gas_side = 'inside'
    wall%rotation_centre = o
    wall%normal = [o, o, 1.0_wp]
    wall%point = [o, o, 0.06_wp]
    scene%cells = [6, 6, 4]
    scene%upper = 0.1_wp*scene%cells
    scene%periodic = [.true., .true., .false.]
    scene%settings%turbulence_model = 'smagorinsky'
    allocate (scene%records(0))
    scene%walls = [wall]
    call make_gas(comm, scene, gas, outcome)
    do j = -1, gas%boxes%n(2) + 2
      do i = -1, gas%boxes%n(1) + 2
        x = place(gas, [i, j, 1], 2)
        gas%velocity(i, j, :, 2) = x(1)
        gas%eddies%eps(i, j, :) = gas%eps(i, j, :)*(50 + 100*x(2))
      end do
    end do
    gas%source = o
    call add_turned(gas, 1)
    force = o
    do k = 1, gas%boxes%n(3)
      associate (largest => maxval(abs(gas%source(1:gas%boxes%n(1), 1:gas%boxes%n(2), k, 1))))
        if (gas%boxes%lo(3) + k - 1 == 1) force(1) = largest
        if (gas%boxes%lo(3) + k - 1 == 2) force(2) = largest
      end associate
    end do
    force = [comm%max(force(1)), comm%max(force(2))]
    x(1) = gas%viscosity*10*0.1_wp**2  ! mu_t grows by 10 mu from cell to cell
    call gas%destroy()
    if (.not. comm%is_root()) return
    call expect_close(force(2), x(1), 1.0e-10_wp, 'stress in whole cells [N]')
    call expect_close(force(1), 0.4_wp*x(1), 1.0e-8_wp, 'stress in cells of which 40 % are open [N]')
  end subroutine cut_cells

end program test_eddy_stress
