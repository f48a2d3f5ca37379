!> What walls within the domain change in the momentum equation of the gas.
!>
!> A face has what its two half cells give it; a cell gives to its two faces across a by their open areas (`upper` of
!> open_space), as a closed one has no gas. Beside the usual terms there is the friction on the walls in the two cells,
!>
!>   sum of mu eps A_wall u/y
!>
!> with the distance y of the middle of the open part of the face from the wall: a straight line to it. The stress between two
!> flows is that where their common surface is, which may be beside the middles of both: `tilts` of open_space. Without that the
!> friction would be of first order.
!> Weight acts on the open area times the distance of the pressures beside it, so that a gas at rest stays so.
module narrow_momentum
  use gas_state, only: gas_state_t, viscous_eps
  use kinds, only: wp
  use mesh, only: unit_step
  use open_space, only: tilt_t
  implicit none
  private
  public :: add_walls, add_seep, tilt_rows

contains

  !> Add to `fixed` and `source` what they have besides with walls.
  subroutine add_walls(state, a)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a

    integer :: i, j, k, e(3), x, y, z, m
    real(wp) :: excess(2), friction, weight, reach

    e = unit_step(a)
    associate (first => state%first(:, a), n => state%boxes%n, space => state%space, eps => state%eps, forces => state%forces, &
               width => state%spacing(a)%width)
      do k = first(3), n(3)
        z = k + e(3)
        do j = first(2), n(2)
          y = j + e(2)
          do i = first(1), n(1)
            if (.not. state%free(i, j, k, a) > 0.0_wp) cycle
            x = i + e(1)
            m = dot_product(e, [i, j, k])
            excess = [space%upper(i, j, k, a) - 0.5_wp, 0.5_wp - space%upper(x, y, z, a)]
            friction = state%viscosity*space%nearness(i, j, k, a) &
              *(space%upper(i, j, k, a)*viscous_eps(state, i, j, k)*space%wall(i, j, k) &
                + (1 - space%upper(x, y, z, a))*viscous_eps(state, x, y, z)*space%wall(x, y, z))
            reach = 0.5_wp*(merge(width(m), 0.0_wp, eps(i, j, k) > 0.0_wp) + merge(width(m + 1), 0.0_wp, eps(x, y, z) > 0.0_wp))
            weight = state%passage(i, j, k, a)*reach &
              - 0.5_wp*(state%volume(i, j, k)*eps(i, j, k) + state%volume(x, y, z)*eps(x, y, z))
            state%fixed(i, j, k, a) = state%fixed(i, j, k, a) + friction &
              + (excess(1)*forces(i, j, k, 1) + excess(2)*forces(x, y, z, 1))
            state%source(i, j, k, a) = state%source(i, j, k, a) + state%density*state%gravity(a)*weight &
              + (excess(1)*forces(i, j, k, 1 + a) + excess(2)*forces(x, y, z, 1 + a))
            if (allocated(space%slide)) state%source(i, j, k, a) = state%source(i, j, k, a) + friction*space%slide(i, j, k, a)
          end do
        end do
      end do
    end associate
  end subroutine add_walls

  !> Gas that comes in through the wall of a cell brings the momentum of its own velocity, across the wall, which is also what
  !> the wall drags the gas to. As its continuity, the diagonal goes by halves to the two faces; the momentum goes
  !> by their open areas: to one alone if the other is closed, from which half of the flow seems to come, at rest.
  subroutine add_seep(state, a)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a

    integer :: i, j, k, e(3), x, y, z
    real(wp) :: share(2), flow(2), friction(2)

    e = unit_step(a)
    associate (first => state%first(:, a), n => state%boxes%n, space => state%space, seep => state%seep)
      do k = first(3), n(3)
        z = k + e(3)
        do j = first(2), n(2)
          y = j + e(2)
          do i = first(1), n(1)
            x = i + e(1)
            if (.not. state%free(i, j, k, a)*(seep(i, j, k) + seep(x, y, z)) > 0.0_wp) cycle
            share = [space%upper(i, j, k, a), 1 - space%upper(x, y, z, a)]
            flow = [seep(i, j, k), seep(x, y, z)]
            friction = share*state%viscosity*space%nearness(i, j, k, a) &
              *[viscous_eps(state, i, j, k)*space%wall(i, j, k), viscous_eps(state, x, y, z)*space%wall(x, y, z)]
            state%fixed(i, j, k, a) = state%fixed(i, j, k, a) + 0.5_wp*sum(flow)
            state%source(i, j, k, a) = state%source(i, j, k, a) &
              + dot_product(share*flow + friction, [seeping(state, a, [i, j, k]), seeping(state, a, [x, y, z])])
          end do
        end do
      end do
    end associate
  end subroutine add_seep

  !> Component a of the velocity with which gas comes through the wall of a cell [m/s].
  pure function seeping(state, a, cell) result(velocity)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, cell(3)
    real(wp) :: velocity

    integer :: x(3), e(3), b
    real(wp) :: facing, density

    velocity = 0.0_wp
    x = cell
    e = unit_step(a)
    if (.not. abs(state%seep(x(1), x(2), x(3))) > 0.0_wp) return
    facing = state%space%area(x(1), x(2), x(3), a) - state%space%area(x(1) - e(1), x(2) - e(2), x(3) - e(3), a)
    do b = 1, 3
      if (b /= a) facing = facing*state%spacing(b)%width(x(b))
    end do
    density = state%density
    if (allocated(state%ideal)) density = state%ideal%density(x(1), x(2), x(3))
    velocity = state%seep(x(1), x(2), x(3))*facing &
      /(density*state%eps(x(1), x(2), x(3))*state%space%wall(x(1), x(2), x(3))**2)
  end function seeping

  !> Add to rows that are otherwise complete what the stress between flows is more than that of their middles.
  subroutine tilt_rows(state, a)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a

    real(wp) :: more(2), wall
    integer :: m, x(3), y(3)

    associate (s => state%stencil(a))
      do m = 1, size(state%space%tilts)
        associate (tilt => state%space%tilts(m))
          if (tilt%a /= a) cycle
          more = tilt%more*ease(state, tilt)
          x = tilt%face
          y = x + unit_step(tilt%b)
          wall = 0.0_wp
          if (allocated(state%space%slide)) wall = more(1)*state%space%slide(x(1), x(2), x(3), a) &
                                                   - more(2)*state%space%slide(y(1), y(2), y(3), a)
          if (is_solved(state, a, x)) then
            s%centre(x(1), x(2), x(3)) = s%centre(x(1), x(2), x(3)) + more(1)
            s%high(x(1), tilt%b, x(2), x(3)) = s%high(x(1), tilt%b, x(2), x(3)) + more(2)
            s%rhs(x(1), x(2), x(3)) = s%rhs(x(1), x(2), x(3)) + wall
          end if
          if (is_solved(state, a, y)) then
            s%centre(y(1), y(2), y(3)) = s%centre(y(1), y(2), y(3)) + more(2)
            s%low(y(1), tilt%b, y(2), y(3)) = s%low(y(1), tilt%b, y(2), y(3)) + more(1)
            s%rhs(y(1), y(2), y(3)) = s%rhs(y(1), y(2), y(3)) - wall
          end if
        end associate
      end do
    end associate
  end subroutine tilt_rows

  !> Whether the velocity on a face is an unknown of mine.
  pure function is_solved(state, a, face)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, face(3)
    logical :: is_solved

    is_solved = all(face >= state%stencil(a)%lo .and. face <= state%stencil(a)%n)
    if (is_solved) is_solved = state%free(face(1), face(2), face(3), a) > 0.0_wp
  end function is_solved

  !> Viscous stress times area between two flows over the difference of their velocities, as in momentum_cells [kg/s].
  pure function ease(state, tilt)
    class(gas_state_t), intent(in) :: state
    type(tilt_t), intent(in) :: tilt
    real(wp) :: ease

    integer :: x(3), y(3), s(3), e(3), along

    x = tilt%face
    e = unit_step(tilt%a)
    s = unit_step(tilt%b)
    y = x + s
    along = 6 - tilt%a - tilt%b
    associate (spacing => state%spacing)
      ease = 0.25_wp*state%viscosity*state%space%bridge(x(1), x(2), x(3), tilt%b, tilt%a) &
        *spacing(along)%width(x(along))*spacing(tilt%a)%gap(x(tilt%a))/spacing(tilt%b)%gap(x(tilt%b)) &
        *(viscous_eps(state, x(1), x(2), x(3)) + viscous_eps(state, x(1) + e(1), x(2) + e(2), x(3) + e(3)) &
          + viscous_eps(state, y(1), y(2), y(3)) + viscous_eps(state, y(1) + e(1), y(2) + e(2), y(3) + e(3)))
    end associate
  end function ease

end module narrow_momentum
