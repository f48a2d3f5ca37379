!> The cells of the momentum equation, half a cell beside those of the pressure, and what crosses their faces.
!>
!> The face of index P across b of the cell around velocity a at P lies between the velocities at P and P + e_b.
!> Its mass flow is the mean of those through the two pressure-cell faces it is made of, so that the momentum cell
!> keeps the continuity of its two halves.
module momentum_cells
  use convection, only: limited
  use gas_state, only: gas_state_t, spacing_t
  use kinds, only: wp
  use mesh, only: unit_step
  implicit none
  private
  public :: sweep_t, new_sweep, find_crossing, fill_beyond, continue_across, bend_at, rub

  integer, parameter :: stretch = 128  !< faces of a row at a time, whose work stays in the nearest cache

  !> One pass over the faces across b of the momentum cells of component a.
  type :: sweep_t
    private
    integer :: limiter
    integer :: n(3)
    integer :: a, b
    integer :: e(3), s(3)     !< unit steps along a and b
    integer :: cell(3)        !< how far apart in memory cells are along each axis
    integer :: ahead, beside  !< and along a and b
    integer :: corner(4)      !< how far the pressure cells are whose void fraction counts
    integer :: first          !< face along x
    integer :: surface(2)     !< index along b of the faces on the low and the high surface of the domain
    logical :: at_surface(2)  !< whether they are mine
    logical :: graded         !< the axis b
    real(wp), allocatable :: along_x(:), along_y(:), along_z(:)  !< whose product is mu A/h/4 [kg/s]
    real(wp), allocatable :: slope(:,:), lean(:,:)               !< see find_slopes
  end type sweep_t

contains

  !> Filled in place: gfortran 12 loses the memory of an array made from function results.
  subroutine new_sweep(state, a, b, sweep)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, b
    type(sweep_t), intent(out) :: sweep

    sweep%limiter = state%limiter
    sweep%n = state%boxes%n
    sweep%a = a
    sweep%b = b
    sweep%e = unit_step(a)
    sweep%s = unit_step(b)
    sweep%cell = [1, sweep%n(1) + 4, (sweep%n(1) + 4)*(sweep%n(2) + 4)]
    sweep%ahead = sweep%cell(a)
    sweep%beside = sweep%cell(b)
    ! the pressure cell that a face halves (b = a), or the four that meet at it
    sweep%corner = sweep%ahead
    if (a /= b) sweep%corner = [0, sweep%ahead, sweep%beside, sweep%ahead + sweep%beside]
    sweep%first = merge(0, state%first(1, a), b == 1)
    sweep%surface = [merge(-1, 0, a == b), state%boxes%n(b)]
    sweep%at_surface = state%boundary%side(:, b)%mine
    sweep%graded = .not. state%mesh%axis(b)%uniform
    allocate (sweep%along_x(0:sweep%n(1)), source=shape_of(sweep, state%spacing(1), 1))
    ! friction on the surface of the domain is treated apart
    if (b == 1 .and. a /= 1 .and. sweep%at_surface(1)) sweep%along_x(0) = 0.0_wp
    if (b == 1 .and. sweep%at_surface(2)) sweep%along_x(sweep%n(1)) = 0.0_wp
    allocate (sweep%along_y(0:sweep%n(2)), source=0.25_wp*state%viscosity*shape_of(sweep, state%spacing(2), 2))
    allocate (sweep%along_z(0:sweep%n(3)), source=shape_of(sweep, state%spacing(3), 3))
    if (sweep%graded) call find_slopes(sweep, state%spacing(b))
  end subroutine new_sweep

  !> What crosses the faces (:, row) of a sweep: coefficients of the cell below for the one above (1) and the reverse (2),
  !> and the momentum the limiter adds (3).
  subroutine find_crossing(state, sweep, row, crossing)
    class(gas_state_t), intent(in) :: state
    type(sweep_t), intent(in) :: sweep
    integer, intent(in) :: row(2)                        !< (y, z)
    real(wp), intent(out) :: crossing(-1:sweep%n(1), 3)  !< (x, what)

    integer :: end, place

    associate (a => sweep%a, b => sweep%b, first => sweep%first, n => sweep%n)
      place = dot_product(sweep%s(2:3), row)
      if (b == 1 .or. .not. any(sweep%at_surface .and. sweep%surface == place)) then
        if (allocated(state%eddies)) then
          call cross_inside(state, sweep, row, state%eddies%eps, crossing)
        else
          call cross_inside(state, sweep, row, state%eps, crossing)
        end if
      else
        call cross_surface(sweep, first, n(1), row, state%flux(:, :, :, b), crossing)
      end if
      if (b /= 1) return
      do end = 1, 2
        if (.not. sweep%at_surface(end)) cycle
        if (sweep%surface(end) >= first) crossing(sweep%surface(end), 3) = 0.0_wp
        if (sweep%surface(end) < first) call cross_surface(sweep, -1, -1, row, state%flux(:, :, :, b), crossing)
      end do
    end associate
  end subroutine find_crossing

  !> Those between two cells, of a void fraction as viscous stress has it.
  subroutine cross_inside(state, sweep, row, eps, crossing)
    class(gas_state_t), intent(in) :: state
    type(sweep_t), intent(in) :: sweep
    integer, intent(in) :: row(2)
    real(wp), intent(in), contiguous :: eps(-1:, -1:, -1:)
    real(wp), intent(inout) :: crossing(-1:sweep%n(1), 3)

    associate (a => sweep%a, b => sweep%b)
      if (allocated(state%space)) then
        call cross(sweep, row, eps, state%flux(:, :, :, b), state%velocity(:, :, :, a), crossing, &
                   state%space%bridge(:, :, :, b, a))
      else
        call cross(sweep, row, eps, state%flux(:, :, :, b), state%velocity(:, :, :, a), crossing)
      end if
    end associate
  end subroutine cross_inside

  pure subroutine cross(sweep, row, eps, flux, u, crossing, bridge)
    type(sweep_t), intent(in) :: sweep
    integer, intent(in) :: row(2)
    real(wp), intent(in), dimension(product(sweep%n + 4)) :: eps, flux, u  !< of all cells, in memory one row behind the other
    real(wp), intent(inout) :: crossing(-1:sweep%n(1), 3)
    real(wp), intent(in), optional :: bridge(-1:sweep%n(1), -1:sweep%n(2), -1:sweep%n(3))  !< see open_space

    real(wp), dimension(stretch) :: flow, before, beyond, upper, step, extra, ease
    real(wp) :: mu, viscous
    integer :: at, from, i, j, k, m, x

    j = row(1)
    k = row(2)
    mu = sweep%along_y(j)*sweep%along_z(k)
    associate (ahead => sweep%ahead, beside => sweep%beside, c => sweep%corner)
      do from = sweep%first, sweep%n(1), stretch
        m = min(stretch, sweep%n(1) - from + 1)
        at = 1 + dot_product(sweep%cell, [from, j + 1, k + 1])  ! the cell before the stretch
        do i = 1, m
          flow(i) = 0.5_wp*(flux(at + i) + flux(at + ahead + i))
          step(i) = u(at + beside + i) - u(at + i)
          before(i) = u(at + i) - u(at - beside + i)
          beyond(i) = u(at + 2*beside + i) - u(at + beside + i)
          ease(i) = mu*sweep%along_x(from + i - 1)
        end do
        do i = 1, m  ! on their own: loaded under a condition they would be gathered one by one
          upper(i) = merge(before(i), beyond(i), flow(i) > 0.0_wp)
        end do
        if (sweep%graded) call scale_row(sweep, from, row, sweep%slope, flow(:m), upper(:m))
        call limited(sweep%limiter, m, upper, step, extra)
        if (sweep%graded) call scale_row(sweep, from, row, sweep%lean, flow(:m), extra(:m))
        if (present(bridge)) ease(:m) = ease(:m)*bridge(from:from + m - 1, j, k)
        do i = 1, m
          x = from + i - 1
          viscous = ease(i)*(eps(at + c(1) + i) + eps(at + c(2) + i) + eps(at + c(3) + i) + eps(at + c(4) + i))
          crossing(x, 1) = viscous + max(flow(i), 0.0_wp)
          crossing(x, 2) = viscous + max(-flow(i), 0.0_wp)
          crossing(x, 3) = abs(flow(i))*extra(i)
        end do
      end do
    end associate
  end subroutine cross

  !> Those on the surface of the domain: friction is treated apart, the mass flow is that through the surface itself.
  pure subroutine cross_surface(sweep, from, to, row, flux, crossing)
    type(sweep_t), intent(in) :: sweep
    integer, intent(in) :: from, to, row(2)
    real(wp), intent(in) :: flux(-1:sweep%n(1) + 2, -1:sweep%n(2) + 2, -1:sweep%n(3) + 2)
    real(wp), intent(inout) :: crossing(-1:sweep%n(1), 3)

    integer :: i
    real(wp) :: flow

    associate (j => row(1), k => row(2), e => sweep%e)
      do i = from, to
        flow = 0.5_wp*(flux(i, j, k) + flux(i + e(1), j + e(2), k + e(3)))
        crossing(i, 1) = max(flow, 0.0_wp)
        crossing(i, 2) = max(-flow, 0.0_wp)
        crossing(i, 3) = 0.0_wp
      end do
    end associate
  end subroutine cross_surface

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
  pure subroutine find_slopes(sweep, spacing)
    type(sweep_t), intent(inout) :: sweep
    type(spacing_t), intent(in) :: spacing  !< along b

    real(wp) :: distance(-1:sweep%n(sweep%b) + 1)
    integer :: n

    n = sweep%n(sweep%b)
    distance = distances(sweep, spacing, -1, n + 1)
    allocate (sweep%slope(2, 0:n), sweep%lean(2, 0:n))
    sweep%slope(1, :) = distance(0:n)/distance(-1:n - 1)
    sweep%slope(2, :) = distance(0:n)/distance(1:n + 1)
    sweep%lean = 1.0_wp
    if (sweep%a == sweep%b) return
    sweep%lean(1, :) = spacing%width(0:n)/distance(0:n)
    sweep%lean(2, :) = spacing%width(1:n + 1)/distance(0:n)
  end subroutine find_slopes

  !> Multiply a stretch of a row by the factors of its faces.
  pure subroutine scale_row(sweep, from, row, factor, flow, values)
    type(sweep_t), intent(in) :: sweep
    integer, intent(in) :: from, row(2)
    real(wp), intent(in) :: factor(2, 0:sweep%n(sweep%b))
    real(wp), intent(in) :: flow(:)
    real(wp), intent(inout) :: values(:)

    integer :: i, m

    do i = 1, size(values)
      m = dot_product(sweep%s, [from + i - 1, row])
      values(i) = values(i)*merge(factor(1, m), factor(2, m), flow(i) > 0.0_wp)
    end do
  end subroutine scale_row

  !> Friction on a wall of velocity U from a parabola through the wall and the next two unknowns, at y_1 and y_2,
  !>   du/dy = ((u_1 - U) y_2/y_1 - (u_2 - U) y_1/y_2)/(y_2 - y_1),
  !> written as (own (u_1 - U) - next (u_2 - u_1))/h_1: on a uniform grid own = 8/3, next = 1/3. It makes the flow between
  !> plates exact, where a straight line to the wall leaves an error of dp/dx h^2/(8 mu).
  pure subroutine bend(width, next_width, own, next)
    real(wp), intent(in) :: width, next_width  !< of the two cells at the wall [m]
    real(wp), intent(out) :: own, next

    real(wp) :: first, second

    first = 0.5_wp
    second = 1.0_wp + 0.5_wp*next_width/width
    next = first/(second*(second - first))
    own = second/(first*(second - first)) - next
  end subroutine bend

  !> The same for the wall at one end of direction b; a straight line where the domain is one cell wide.
  pure subroutine bend_at(state, b, end, own, next)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: b, end
    real(wp), intent(out) :: own, next

    own = 2.0_wp
    next = 0.0_wp
    if (state%mesh%n(b) == 1) return
    associate (width => state%mesh%axis(b)%width, n => state%mesh%n(b))
      if (end == 1) call bend(width(1), width(2), own, next)
      if (end == 2) call bend(width(n), width(n - 1), own, next)
    end associate
  end subroutine bend_at

  !> eps mu A/h over the part of a side across b on which the gas sticks, beside the faces lo..hi of component a [kg/s]; times
  !> the velocity of the wall if `grip` is [N].
  pure subroutine rub(state, a, b, end, lo, hi, first, grip, friction)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, b, end, lo(3), hi(3), first(3)
    real(wp), intent(in) :: grip(first(1):, first(2):, first(3):)  !< (faces of the side) part that sticks [-]
    real(wp), intent(out) :: friction(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3))

    if (allocated(state%eddies)) then
      call rub_cells(state, a, b, end, lo, hi, first, state%eddies%eps, grip, friction)
    else
      call rub_cells(state, a, b, end, lo, hi, first, state%eps, grip, friction)
    end if
  end subroutine rub

  !> The same with the void fraction as viscous stress has it.
  pure subroutine rub_cells(state, a, b, end, lo, hi, first, eps, grip, friction)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, b, end, lo(3), hi(3), first(3)
    real(wp), intent(in), contiguous :: eps(-1:, -1:, -1:)
    real(wp), intent(in) :: grip(first(1):, first(2):, first(3):)
    real(wp), intent(out) :: friction(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3))

    integer :: i, j, k, e(3), d(3)  ! d: from a cell to its face on the side
    real(wp) :: factor

    e = unit_step(a)
    d = (merge(0, state%boxes%n(b), end == 1) - lo(b))*unit_step(b)
    factor = 0.5_wp*state%viscosity/state%spacing(b)%width(lo(b))**2
    associate (volume => state%volume)
      do k = lo(3), hi(3)
        do j = lo(2), hi(2)
          do i = lo(1), hi(1)
            friction(i, j, k) = factor* &
              (eps(i, j, k)*volume(i, j, k)*grip(i + d(1), j + d(2), k + d(3)) &
               + eps(i + e(1), j + e(2), k + e(3))*volume(i + e(1), j + e(2), k + e(3)) &
                 *grip(i + d(1) + e(1), j + d(2) + e(2), k + d(3) + e(3)))
          end do
        end do
      end do
    end associate
  end subroutine rub_cells

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
          if (a == b) call continue_across(state%boxes%n, a, end, state%velocity(:, :, :, a))
          if (a /= b) call continue_along(state, a, b, end)
        end do
      end do
    end do
  end subroutine fill_beyond

  !> Give the first layer of faces beyond the surface at one end of a what is on it.
  pure subroutine continue_across(n, a, end, f)
    integer, intent(in) :: n(3), a, end
    real(wp), intent(inout) :: f(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)

    select case (2*a + end)
    case (3)
      f(-1, :, :) = f(0, :, :)
    case (4)
      f(n(1) + 1, :, :) = f(n(1), :, :)
    case (5)
      f(:, -1, :) = f(:, 0, :)
    case (6)
      f(:, n(2) + 1, :) = f(:, n(2), :)
    case (7)
      f(:, :, -1) = f(:, :, 0)
    case default
      f(:, :, n(3) + 1) = f(:, :, n(3))
    end select
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
