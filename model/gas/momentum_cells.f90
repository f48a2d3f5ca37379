!> The cells of the momentum equation, half a cell beside those of the pressure, and what crosses their faces.
!>
!> The face of index P across b of the cell around velocity a at P lies between the velocities at P and P + e_b.
!> Its mass flow is the mean of those through the two pressure-cell faces it is made of, so that the momentum cell
!> keeps the continuity of its two halves.
module momentum_cells
  use convection, only: limited
  use gas_state, only: gas_state_t, spacing_t, unit_step
  use kinds, only: wp
  implicit none
  private
  public :: find_crossing, fill_beyond, wall_conductance, wall_push

  !> One pass over the faces across b of the momentum cells of component a.
  type :: sweep_t
    integer :: limiter
    real(wp) :: viscosity     !< [Pa s]
    integer :: lo(3), n(3)    !< first and last face
    integer :: a, b
    integer :: e(3), s(3)     !< unit steps along a and b
    integer :: corner(3, 4)   !< offsets of the pressure cells whose void fraction counts
    logical :: graded         !< the axis b
  end type sweep_t

contains

  !> What crosses the faces across b of the cells of component a.
  subroutine find_crossing(state, a, b)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a, b

    type(sweep_t) :: sweep
    integer :: e(3), s(3)

    e = unit_step(a)
    s = unit_step(b)
    sweep%limiter = state%limiter
    sweep%viscosity = state%viscosity
    sweep%n = state%boxes%n
    sweep%lo = state%first(:, a)
    sweep%lo(b) = 0
    sweep%a = a
    sweep%b = b
    sweep%e = e
    sweep%s = s
    sweep%graded = .not. state%mesh%axis(b)%uniform
    ! the pressure cell that a face halves (b = a), or the four that meet at it
    if (a == b) sweep%corner = spread(e, 2, 4)
    if (a /= b) sweep%corner = reshape([0*e, e, s, e + s], [3, 4])
    if (allocated(state%space)) then
      call cross(sweep, state%spacing, state%eps, state%flux(:, :, :, b), state%velocity(:, :, :, a), state%crossing, &
                 state%space%bridge(:, :, :, b, a))
    else
      call cross(sweep, state%spacing, state%eps, state%flux(:, :, :, b), state%velocity(:, :, :, a), state%crossing)
    end if
    call set_surface(state, a, b)
  end subroutine find_crossing

  !> The rows of faces of one sweep: coefficients of the cell below for the one above (1) and the reverse (2), and the
  !> momentum the limiter adds (3).
  pure subroutine cross(sweep, spacing, eps, flux, u, crossing, bridge)
    type(sweep_t), intent(in) :: sweep
    type(spacing_t), intent(in) :: spacing(3)
    real(wp), intent(in), dimension(-1:sweep%n(1) + 2, -1:sweep%n(2) + 2, -1:sweep%n(3) + 2) :: eps, flux, u
    real(wp), intent(inout) :: crossing(-1:sweep%n(1), -1:sweep%n(2), -1:sweep%n(3), 3)
    real(wp), intent(in), optional :: bridge(-1:sweep%n(1), -1:sweep%n(2), -1:sweep%n(3))  !< see open_space

    real(wp), dimension(sweep%lo(1):sweep%n(1)) :: flow, upper, step, extra, ease
    real(wp) :: along_x(0:sweep%n(1)), along_y(0:sweep%n(2)), along_z(0:sweep%n(3)), mu, viscous
    real(wp) :: slope(2, 0:sweep%n(sweep%b)), lean(2, 0:sweep%n(sweep%b))
    integer :: i, j, k

    along_x = shape_of(sweep, spacing(1), 1)
    along_y = shape_of(sweep, spacing(2), 2)
    along_z = shape_of(sweep, spacing(3), 3)
    if (sweep%graded) call find_slopes(sweep, spacing(sweep%b), slope, lean)
    associate (e => sweep%e, s => sweep%s, c => sweep%corner, lo => sweep%lo, n => sweep%n)
      do k = lo(3), n(3)
        do j = lo(2), n(2)
          do i = lo(1), n(1)
            flow(i) = 0.5_wp*(flux(i, j, k) + flux(i + e(1), j + e(2), k + e(3)))
            step(i) = u(i + s(1), j + s(2), k + s(3)) - u(i, j, k)
            upper(i) = merge(u(i, j, k) - u(i - s(1), j - s(2), k - s(3)), &
                             u(i + 2*s(1), j + 2*s(2), k + 2*s(3)) - u(i + s(1), j + s(2), k + s(3)), flow(i) > 0.0_wp)
          end do
          if (sweep%graded) call scale_row(sweep, j, k, slope, flow, upper)
          call limited(sweep%limiter, n(1) - lo(1) + 1, upper, step, extra)
          if (sweep%graded) call scale_row(sweep, j, k, lean, flow, extra)
          mu = 0.25_wp*sweep%viscosity*along_y(j)*along_z(k)
          ease = mu*along_x(lo(1):n(1))
          if (present(bridge)) ease = ease*bridge(lo(1):n(1), j, k)
          do i = lo(1), n(1)
            viscous = ease(i)*(eps(i + c(1, 1), j + c(2, 1), k + c(3, 1)) &
              + eps(i + c(1, 2), j + c(2, 2), k + c(3, 2)) + eps(i + c(1, 3), j + c(2, 3), k + c(3, 3)) &
              + eps(i + c(1, 4), j + c(2, 4), k + c(3, 4)))
            crossing(i, j, k, 1) = viscous + max(flow(i), 0.0_wp)
            crossing(i, j, k, 2) = viscous + max(-flow(i), 0.0_wp)
            crossing(i, j, k, 3) = abs(flow(i))*extra(i)
          end do
        end do
      end do
    end associate
  end subroutine cross

  !> What the grid along one direction contributes to A/h of the faces of a sweep; the product of the three is A/h.
  pure function shape_of(sweep, spacing, direction) result(factor)
    type(sweep_t), intent(in) :: sweep
    type(spacing_t), intent(in) :: spacing
    integer, intent(in) :: direction
    real(wp) :: factor(0:sweep%n(direction))

    integer :: n

    n = sweep%n(direction)
    factor = spacing%width(0:n)
    if (direction == sweep%a) factor = spacing%gap(0:n)
    if (direction == sweep%b) factor = 1.0_wp/distances(sweep, spacing, 0, n)
  end function shape_of

  !> Distances between the velocities on both sides of the faces from..to of a sweep, along b [m].
  pure function distances(sweep, spacing, from, to) result(distance)
    type(sweep_t), intent(in) :: sweep
    type(spacing_t), intent(in) :: spacing  !< along b
    integer, intent(in) :: from, to
    real(wp) :: distance(from:to)

    distance = spacing%gap(from:to)
    if (sweep%a == sweep%b) distance = spacing%width(from + 1:to + 1)
  end function distances

  !> On a graded axis, by which factor the difference upwind of a face is to be multiplied to be a slope over the
  !> distance across the face, and what the limiter adds for a face that is not half-way: from below (1), from above (2).
  pure subroutine find_slopes(sweep, spacing, slope, lean)
    type(sweep_t), intent(in) :: sweep
    type(spacing_t), intent(in) :: spacing  !< along b
    real(wp), intent(out), dimension(2, 0:sweep%n(sweep%b)) :: slope, lean

    real(wp) :: distance(-1:sweep%n(sweep%b) + 1)
    integer :: n

    n = sweep%n(sweep%b)
    distance = distances(sweep, spacing, -1, n + 1)
    slope(1, :) = distance(0:n)/distance(-1:n - 1)
    slope(2, :) = distance(0:n)/distance(1:n + 1)
    lean = 1.0_wp
    if (sweep%a == sweep%b) return
    lean(1, :) = spacing%width(0:n)/distance(0:n)
    lean(2, :) = spacing%width(1:n + 1)/distance(0:n)
  end subroutine find_slopes

  !> Multiply a row by the factors of its faces.
  pure subroutine scale_row(sweep, j, k, factor, flow, row)
    type(sweep_t), intent(in) :: sweep
    integer, intent(in) :: j, k
    real(wp), intent(in) :: factor(2, 0:sweep%n(sweep%b))
    real(wp), intent(in) :: flow(sweep%lo(1):sweep%n(1))
    real(wp), intent(inout) :: row(sweep%lo(1):sweep%n(1))

    integer :: i, m

    do i = sweep%lo(1), sweep%n(1)
      m = dot_product(sweep%s, [i, j, k])
      row(i) = row(i)*merge(factor(1, m), factor(2, m), flow(i) > 0.0_wp)
    end do
  end subroutine scale_row

  !> Faces on the surface of the domain: friction is treated apart, the mass flow is that through the surface itself,
  !> and only what comes in counts.
  subroutine set_surface(state, a, b)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a, b

    integer :: end, i, j, k, lo(3), hi(3), e(3), face(3)
    real(wp) :: inward

    e = merge(0, 1, b == a)*unit_step(a)
    do end = 1, 2
      if (.not. state%boundary%side(end, b)%mine) cycle
      lo = state%first(:, a)
      hi = state%boxes%n
      lo(b) = merge(merge(-1, 0, b == a), hi(b), end == 1)
      hi(b) = lo(b)
      face = merge(1, 0, end == 1 .and. b == a)*unit_step(b)
      inward = 0.5_wp*(3 - 2*end)
      do k = lo(3), hi(3)
        do j = lo(2), hi(2)
          do i = lo(1), hi(1)
            state%crossing(i, j, k, end) = max(0.0_wp, inward &
              *(state%flux(i + face(1), j + face(2), k + face(3), b) &
                + state%flux(i + face(1) + e(1), j + face(2) + e(2), k + face(3) + e(3), b)))
            state%crossing(i, j, k, 3) = 0.0_wp
          end do
        end do
      end do
    end do
  end subroutine set_surface

  !> eps mu A/h over the part of the surface across b beside velocity a at `cell` on which the gas sticks [kg/s].
  pure function wall_conductance(state, a, b, end, cell) result(conductance)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, b, end
    integer, intent(in) :: cell(3)
    real(wp) :: conductance

    integer :: x(3), here(3), there(3)

    x = cell + unit_step(a)
    here = cell
    here(b) = merge(0, state%boxes%n(b), end == 1)
    there = here + unit_step(a)
    associate (grip => state%boundary%side(end, b)%grip, eps => state%eps)
      conductance = 0.5_wp*state%viscosity/state%spacing(b)%width(cell(b))**2* &
        (eps(cell(1), cell(2), cell(3))*state%volume(cell(1), cell(2), cell(3))*grip(here(1), here(2), here(3)) &
         + eps(x(1), x(2), x(3))*state%volume(x(1), x(2), x(3))*grip(there(1), there(2), there(3)))
    end associate
  end function wall_conductance

  !> The same times the velocity of the surface, which moves [N].
  pure function wall_push(state, a, b, end, cell) result(push)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, b, end
    integer, intent(in) :: cell(3)
    real(wp) :: push

    integer :: x(3), here(3), there(3)

    x = cell + unit_step(a)
    here = cell
    here(b) = merge(0, state%boxes%n(b), end == 1)
    there = here + unit_step(a)
    associate (grip => state%boundary%side(end, b)%grip, slide => state%boundary%side(end, b)%slide, eps => state%eps)
      push = 0.5_wp*state%viscosity/state%spacing(b)%width(cell(b))**2* &
        (eps(cell(1), cell(2), cell(3))*state%volume(cell(1), cell(2), cell(3)) &
           *grip(here(1), here(2), here(3))*slide(here(1), here(2), here(3), a) &
         + eps(x(1), x(2), x(3))*state%volume(x(1), x(2), x(3)) &
           *grip(there(1), there(2), there(3))*slide(there(1), there(2), there(3), a))
    end associate
  end function wall_push

  !> Velocities in the first layer beyond the surface, which only the limiter sees: along the surface mirrored, about the
  !> velocity of the wall, where the gas sticks and continued where it slips, across it continued.
  subroutine fill_beyond(state)
    class(gas_state_t), intent(inout) :: state

    integer :: a, b, end

    do a = 1, 3
      if (.not. state%stencil(a)%active) cycle
      do b = 1, 3
        do end = 1, 2
          if (.not. state%boundary%side(end, b)%mine) cycle
          if (a == b) call continue_across(state, a, end)
          if (a /= b) call continue_along(state, a, b, end)
        end do
      end do
    end do
  end subroutine fill_beyond

  subroutine continue_across(state, a, end)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a, end

    integer :: n

    n = state%boxes%n(a)
    associate (u => state%velocity)
      select case (2*a + end)
      case (3)
        u(-1, :, :, a) = u(0, :, :, a)
      case (4)
        u(n + 1, :, :, a) = u(n, :, :, a)
      case (5)
        u(:, -1, :, a) = u(:, 0, :, a)
      case (6)
        u(:, n + 1, :, a) = u(:, n, :, a)
      case (7)
        u(:, :, -1, a) = u(:, :, 0, a)
      case default
        u(:, :, n + 1, a) = u(:, :, n, a)
      end select
    end associate
  end subroutine continue_across

  subroutine continue_along(state, a, b, end)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a, b, end

    integer :: i, j, k, lo(3), hi(3), e(3), out(3), face(3)

    e = unit_step(a)
    lo = state%first(:, a)
    hi = state%boxes%n
    if (end == 1) hi(b) = lo(b)
    if (end == 2) lo(b) = hi(b)
    out = (2*end - 3)*unit_step(b)
    face = merge(-1, 0, end == 1)*unit_step(b)
    associate (u => state%velocity, grip => state%boundary%side(end, b)%grip)
      do k = lo(3), hi(3)
        do j = lo(2), hi(2)
          do i = lo(1), hi(1)
            u(i + out(1), j + out(2), k + out(3), a) = u(i, j, k, a) &
              *(1 - grip(i + face(1), j + face(2), k + face(3)) &
                - grip(i + face(1) + e(1), j + face(2) + e(2), k + face(3) + e(3)))
            if (.not. allocated(state%boundary%side(end, b)%slide)) cycle
            associate (slide => state%boundary%side(end, b)%slide)
              u(i + out(1), j + out(2), k + out(3), a) = u(i + out(1), j + out(2), k + out(3), a) &
                + slide(i + face(1), j + face(2), k + face(3), a) &
                + slide(i + face(1) + e(1), j + face(2) + e(2), k + face(3) + e(3), a)
            end associate
          end do
        end do
      end do
    end associate
  end subroutine continue_along

end module momentum_cells
