!> The momentum equation of the gas on the faces of the grid, one component at a time,
!>
!>   eps_old rho V/dt (u - u_old) + sum of (F u)_out - u sum of F_out
!>       = -eps_f A (p_above - p_below) + div(eps mu grad u) V + eps rho g V + S - B u
!>
!> which is the conservative equation less u times the continuity equation: the diagonal is never smaller than the
!> sum of the neighbours. Convection is upwind in the matrix, the limiter's addition in the right-hand side.
!> The viscous stress is eps mu grad u (Laplacian form); what eddies add to it stands in eddy_viscosity. Drag B u - S comes from
!> the cells on both sides of a face.
module momentum
  use eddy_viscosity, only: add_turned
  use gas_density, only: add_inertia, add_weight
  use gas_state, only: gas_state_t, wall_t
  use kinds, only: wp
  use mesh, only: unit_step
  use momentum_cells, only: sweep_t, new_sweep, find_crossing, bend_at, rub
  use momentum_solver, only: find_residual
  use narrow_momentum, only: add_walls, add_seep, tilt_rows
  implicit none
  private
  public :: prepare_momentum, assemble_momentum, drive

  !> The faces of one component next to a side of the domain; none unless it is mine.
  type :: rim_t
    integer :: b = 0, end = 0          !< the side, across b
    integer :: lo(3) = 1, hi(3) = 0
    real(wp) :: next = 0.0_wp          !< see bend of momentum_cells
  end type rim_t

contains

  !> What stays the same over the iterations of a step: diagonals, sources and mobilities.
  subroutine prepare_momentum(state, dt)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(in) :: dt  !< [s]

    integer :: a

    do a = 1, 3
      if (.not. state%stencil(a)%active) cycle
      call set_fixed(state, a, dt)
      call add_friction(state, a)
      if (allocated(state%space)) call add_walls(state, a)
      if (allocated(state%seep)) call add_seep(state, a)
      if (allocated(state%ideal)) call add_inertia(state, a)
      if (allocated(state%eddies)) call add_turned(state, a)
      call set_mobility(state, a)
    end do
  end subroutine prepare_momentum

  !> Inertia and drag of each face. A cell gives half of its drag to each of its two faces across a; what falls on a
  !> given face is borne by the boundary, as the drag of the half cell between it and the first pressure must be.
  !> Given faces keep their velocity, in a row of the size of the others.
  subroutine set_fixed(state, a, dt)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a
    real(wp), intent(in) :: dt

    integer :: i, j, k, e(3), x, y, z
    real(wp) :: inertia, weight, given

    e = unit_step(a)
    given = state%density/dt*product(state%mesh%finest)
    associate (free => state%free, forces => state%forces, first => state%first(:, a), n => state%boxes%n, &
               volume => state%volume, rho => state%density)
      do k = first(3), n(3)
        z = k + e(3)
        do j = first(2), n(2)
          y = j + e(2)
          do i = first(1), n(1)
            x = i + e(1)
            inertia = 0.5_wp*rho/dt*(volume(i, j, k)*state%eps_old(i, j, k) + volume(x, y, z)*state%eps_old(x, y, z))
            weight = 0.5_wp*rho*state%gravity(a)*(volume(i, j, k)*state%eps(i, j, k) + volume(x, y, z)*state%eps(x, y, z))
            state%fixed(i, j, k, a) = free(i, j, k, a)*(inertia + 0.5_wp*(forces(i, j, k, 1) + forces(x, y, z, 1))) &
              + (1 - free(i, j, k, a))*given
            state%source(i, j, k, a) = &
              free(i, j, k, a)*(inertia*state%velocity_before(i, j, k, a) + weight &
                                + 0.5_wp*(forces(i, j, k, 1 + a) + forces(x, y, z, 1 + a))) &
              + (1 - free(i, j, k, a))*given*state%velocity(i, j, k, a)
          end do
        end do
      end do
    end associate
  end subroutine set_fixed

  !> The part of wall friction that acts on a face's own velocity alone, and what a wall that moves adds.
  subroutine add_friction(state, a)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a

    integer :: b, end, lo(3), hi(3)
    real(wp) :: share, next

    do b = 1, 3
      if (b == a) cycle
      do end = 1, 2
        if (.not. state%boundary%side(end, b)%mine) cycle
        call bend_at(state, b, end, share, next)
        call layer_along(state, a, b, end, lo, hi)
        call reserve(state%wall(end, b, a), lo, hi)
        call add_wall(state, a, b, end, lo, hi, share)
      end do
    end do
  end subroutine add_friction

  !> That of one side.
  subroutine add_wall(state, a, b, end, lo, hi, share)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a, b, end, lo(3), hi(3)
    real(wp), intent(in) :: share  !< `own` of bend_at

    real(wp) :: friction(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3))

    associate (side => state%boundary%side(end, b), free => state%free(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), a), &
               fixed => state%fixed(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), a), &
               source => state%source(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), a))
      call rub(state, a, b, end, lo, hi, lbound(side%grip), side%grip, friction)
      friction = free*friction
      state%wall(end, b, a)%conductance = friction
      fixed = fixed + share*friction
      if (.not. allocated(side%slide)) return
      call rub(state, a, b, end, lo, hi, lbound(side%grip), side%grip*side%slide(:, :, :, a), friction)
      source = source + share*free*friction
    end associate
  end subroutine add_wall

  !> Room for the conductances of one wall, made in the first step.
  pure subroutine reserve(wall, lo, hi)
    type(wall_t), intent(inout) :: wall
    integer, intent(in) :: lo(3), hi(3)

    if (.not. allocated(wall%conductance)) allocate (wall%conductance(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)))
  end subroutine reserve

  !> The unknowns of component a in the layer next to one side of the domain across b.
  pure subroutine layer_along(state, a, b, end, lo, hi)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, b, end
    integer, intent(out) :: lo(3), hi(3)

    lo = state%first(:, a)
    hi = state%boxes%n
    if (end == 1) hi(b) = lo(b)
    if (end == 2) lo(b) = hi(b)
  end subroutine layer_along

  !> SIMPLEC: if the neighbours' velocities change as much as a face's own, only `fixed` resists a pressure change
  !> (Van Doormaal and Raithby, Numer. Heat Transfer 7 (1984) 147, eq. 20).
  subroutine set_mobility(state, a)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a

    integer :: i, j, k

    associate (first => state%first(:, a), n => state%boxes%n)
      do k = first(3), n(3)
        do j = first(2), n(2)
          do i = first(1), n(1)
            state%mobility(i, j, k, a) = state%free(i, j, k, a)*state%passage(i, j, k, a)/state%fixed(i, j, k, a)
          end do
        end do
      end do
    end associate
  end subroutine set_mobility

  !> Matrix, right-hand side and residual of every component from the fluxes, velocities and pressures at hand.
  subroutine assemble_momentum(state, sums)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(out) :: sums(2)  !< over my rows: of |residual|, and of |diagonal times velocity| [N]

    real(wp) :: along(0:state%boxes%n(1), 2)
    integer :: a

    along = 0.0_wp
    do a = 1, 3
      if (.not. state%stencil(a)%active) cycle
      call start_forces(state, a)
      call assemble_rows(state, a, along)
      if (.not. allocated(state%space)) cycle
      call tilt_rows(state, a)
      associate (s => state%stencil(a), lo => state%stencil(a)%lo, n => state%stencil(a)%n)
        call find_residual(lo(2:3), n(2:3), lo, n, s%low, s%high, s%centre, s%rhs, state%velocity(:, :, :, a), s%change, along)
      end associate
    end do
    sums = sum(along, 1)
  end subroutine assemble_momentum

  !> What pushes a component that may change within a step: the weight of a density that varies, and a pressure drop along a
  !> periodic direction.
  subroutine start_forces(state, a)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a

    if (.not. pushed(state, a)) return
    state%stencil(a)%rhs = 0.0_wp
    if (allocated(state%ideal)) call add_weight(state, a)
    associate (s => state%stencil(a), length => state%mesh%upper(a) - state%mesh%lower(a))
      call drive(s%lo, s%n, a, state%driving%drop(a)/length*state%spacing(a)%gap, state%passage(:, :, :, a), s%rhs)
    end associate
  end subroutine start_forces

  pure function pushed(state, a)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a
    logical :: pushed

    pushed = allocated(state%ideal) .or. abs(state%driving%drop(a)) > 0.0_wp
  end function pushed

  !> All rows of one component, row of faces by row: what crosses the faces above a row (`above`) is still in the nearest
  !> caches when it is wanted, what crosses those below is kept from the row before and the plane before, and the residual of
  !> a row is found while it is there.
  subroutine assemble_rows(state, a, sums)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a
    real(wp), intent(inout) :: sums(0:state%boxes%n(1), 2)  !< see find_residual

    type(sweep_t) :: sweep(3)
    type(rim_t) :: rims(6)
    real(wp) :: above(-1:state%boxes%n(1), 3, 3)  !< (x, what, b)
    real(wp) :: row_below(-1:state%boxes%n(1), 3)
    real(wp) :: plane_below(-1:state%boxes%n(1), 3, state%first(2, a):state%boxes%n(2))
    integer :: b, j, k
    logical :: more

    do b = 1, 3
      call new_sweep(state, a, b, sweep(b))
    end do
    rims = rims_of(state, a)
    more = pushed(state, a)
    associate (s => state%stencil(a), lo => state%stencil(a)%lo, n => state%boxes%n)
      do j = lo(2), n(2)
        call find_crossing(state, sweep(3), [j, lo(3) - 1], plane_below(:, :, j))
      end do
      do k = lo(3), n(3)
        call find_crossing(state, sweep(2), [lo(2) - 1, k], row_below)
        do j = lo(2), n(2)
          do b = 1, 3
            call find_crossing(state, sweep(b), [j, k], above(:, :, b))
          end do
          if (.not. more) s%rhs(:, j, k) = 0.0_wp
          call gather(a, j, k, lo, n, above, row_below, plane_below(:, :, j), state%free(:, :, :, a), &
                      state%fixed(:, :, :, a), state%source(:, :, :, a), state%passage(:, :, :, a), state%pressure, &
                      s%low, s%high, s%centre, s%rhs)
          call close_row(state, a, j, k, rims)
          if (allocated(state%space)) cycle  ! its walls change rows yet
          call find_residual([j, k], [j, k], lo, n, s%low, s%high, s%centre, s%rhs, state%velocity(:, :, :, a), s%change, sums)
        end do
      end do
    end associate
  end subroutine assemble_rows

  !> A row of faces: coefficients of the neighbours below and above, which the diagonal gathers beside what it has of its own;
  !> source - a (p_above - p_below), beside what stands on the right already, and what the limiter adds to the upwind flows in,
  !> less what it adds to those out. Where the velocity is given there is nothing but `fixed` and `source`. What was above the row
  !> is below the next.
  pure subroutine gather(a, j, k, lo, n, above, row_below, plane_below, free, fixed, source, passage, p, low, high, centre, rhs)
    integer, intent(in) :: a, j, k, lo(3), n(3)
    real(wp), intent(in) :: above(-1:n(1), 3, 3)
    real(wp), intent(inout), dimension(-1:n(1), 3) :: row_below, plane_below
    real(wp), intent(in), dimension(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2) :: free, fixed, source, passage, p
    real(wp), intent(inout), dimension(lo(1):n(1), 3, lo(2):n(2), lo(3):n(3)) :: low, high
    real(wp), intent(inout), dimension(lo(1):n(1), lo(2):n(2), lo(3):n(3)) :: centre, rhs

    integer :: i, e(3)
    real(wp) :: push

    e = unit_step(a)
    do i = lo(1), n(1)
      push = rhs(i, j, k) - passage(i, j, k)*(p(i + e(1), j + e(2), k + e(3)) - p(i, j, k))
      push = push + (above(i - 1, 3, 1) - above(i, 3, 1)) + (row_below(i, 3) - above(i, 3, 2)) &
        + (plane_below(i, 3) - above(i, 3, 3))
      low(i, 1, j, k) = free(i, j, k)*above(i - 1, 1, 1)
      low(i, 2, j, k) = free(i, j, k)*row_below(i, 1)
      low(i, 3, j, k) = free(i, j, k)*plane_below(i, 1)
      high(i, 1, j, k) = free(i, j, k)*above(i, 2, 1)
      high(i, 2, j, k) = free(i, j, k)*above(i, 2, 2)
      high(i, 3, j, k) = free(i, j, k)*above(i, 2, 3)
      centre(i, j, k) = fixed(i, j, k) + (low(i, 1, j, k) + high(i, 1, j, k)) + (low(i, 2, j, k) + high(i, 2, j, k)) &
        + (low(i, 3, j, k) + high(i, 3, j, k))
      rhs(i, j, k) = source(i, j, k) + free(i, j, k)*push
      row_below(i, 1) = above(i, 1, 2)
      row_below(i, 3) = above(i, 3, 2)
      plane_below(i, 1) = above(i, 1, 3)
      plane_below(i, 3) = above(i, 3, 3)
    end do
  end subroutine gather

  !> rhs + a dp, dp the part of the pressure drop along a periodic direction between two cells, see driving.
  pure subroutine drive(lo, n, a, drop, passage, rhs)
    integer, intent(in) :: lo(3), n(3), a
    real(wp), intent(in) :: drop(-1:n(a) + 1)  !< [Pa]
    real(wp), intent(in) :: passage(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)
    real(wp), intent(inout) :: rhs(lo(1):n(1), lo(2):n(2), lo(3):n(3))

    integer :: i, j, k, e(3)

    e = unit_step(a)
    do k = lo(3), n(3)
      do j = lo(2), n(2)
        do i = lo(1), n(1)
          rhs(i, j, k) = rhs(i, j, k) + passage(i, j, k)*drop(dot_product(e, [i, j, k]))
        end do
      end do
    end do
  end subroutine drive

  !> The sides of the domain that rows of component a touch, those across a last.
  pure function rims_of(state, a) result(rims)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a
    type(rim_t) :: rims(6)

    integer :: m, b, end
    real(wp) :: own

    do m = 1, 6
      b = modulo(a + (m - 1)/2, 3) + 1
      end = modulo(m - 1, 2) + 1
      rims(m)%b = b
      rims(m)%end = end
      if (.not. state%boundary%side(end, b)%mine) cycle
      call layer_along(state, a, b, end, rims(m)%lo, rims(m)%hi)
      if (state%mesh%n(b) > 1 .and. b /= a) call bend_at(state, b, end, own, rims(m)%next)
    end do
  end function rims_of

  !> On the surface of the domain there is no neighbour: what comes in brings no momentum along the face, and what
  !> comes back through an open face none at all, so its flux stays in the diagonal and damps.
  subroutine close_row(state, a, j, k, rims)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a, j, k
    type(rim_t), intent(in) :: rims(6)

    integer :: m

    do m = 1, 6
      if (.not. touches(rims(m), j, k)) cycle
      associate (s => state%stencil(a), b => rims(m)%b, end => rims(m)%end, from => rims(m)%lo(1), to => rims(m)%hi(1))
        if (end == 1) s%low(from:to, b, j, k) = 0.0_wp
        if (end == 2) s%high(from:to, b, j, k) = 0.0_wp
        if (.not. rims(m)%next > 0.0_wp) cycle
        associate (wall => state%wall(end, b, a)%conductance)
          if (end == 1) call bend_row(rims(m), wall(from:to, j, k), s%centre(from:to, j, k), s%high(from:to, b, j, k))
          if (end == 2) call bend_row(rims(m), wall(from:to, j, k), s%centre(from:to, j, k), s%low(from:to, b, j, k))
        end associate
      end associate
    end do
  end subroutine close_row

  !> What friction on a wall has of the velocities one further in.
  pure subroutine bend_row(rim, wall, centre, inner)
    type(rim_t), intent(in) :: rim
    real(wp), intent(in) :: wall(rim%lo(1):rim%hi(1))
    real(wp), intent(inout), dimension(rim%lo(1):rim%hi(1)) :: centre, inner

    integer :: i

    do i = rim%lo(1), rim%hi(1)
      centre(i) = centre(i) + rim%next*wall(i)
      inner(i) = inner(i) + rim%next*wall(i)
    end do
  end subroutine bend_row

  !> Whether a row of faces lies at a side.
  pure function touches(rim, j, k)
    type(rim_t), intent(in) :: rim
    integer, intent(in) :: j, k
    logical :: touches

    touches = j >= rim%lo(2) .and. j <= rim%hi(2) .and. k >= rim%lo(3) .and. k <= rim%hi(3)
  end function touches

end module momentum
