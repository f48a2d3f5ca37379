!> Clouds of parcels: what the cells get against a direct sum over all parcels, on any number of ranks.
program test_coupling_cloud
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi, is_set
  use coupling_scene, only: scene_t, build, add, recouple, gravity, viscosity, density
  use coupling_settings, only: coupling_settings_t
  use diffusion_kernel, only: kernel_row, kernel_reach
  use drag_gidaspow, only: gidaspow
  use kinds, only: wp
  use mesh, only: mesh_t
  use parcels, only: velocity_row, drag_row, before_row
  implicit none

  integer, parameter :: total = 400
  real(wp), parameter :: dt = 1.0e-3_wp, dt_before = 0.7e-3_wp, solid_density = 2500.0_wp

  !> All parcels of a cloud, known to every rank.
  type :: cloud_t
    real(wp), dimension(3, total) :: x, moved, velocity, before, drag
    real(wp), dimension(total) :: diameter, weight
    logical :: new(total)
  end type cloud_t

  type(communicator_t) :: comm

  call start_ranks(comm)
  call check_cloud([8, 12, 6], [.false., .false., .false.], 'walls')
  call check_cloud([8, 12, 6], [.false., .false., .false.], 'walls, by cell', 'cell')
  call check_cloud([8, 12, 6], [.false., .false., .false.], 'walls, wide', width=0.02_wp)
  call check_cloud([8, 10, 6], [.true., .false., .true.], 'periodic in x and z, by cell and wide', 'cell', 0.025_wp)
  call check_cloud([12, 16, 1], [.true., .false., .false.], 'one cell thick, wide', width=0.004_wp)
  call check_cloud([8, 10, 6], [.true., .false., .true.], 'periodic in x and z')
  call check_cloud([12, 16, 1], [.true., .false., .false.], 'one cell thick')
  call check_clipping()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  subroutine check_cloud(n, periodic, name, mapping, width)
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    character(len=*), intent(in) :: name
    character(len=*), intent(in), optional :: mapping  !< 'linear' unless given
    real(wp), intent(in), optional :: width            !< none unless given [m]

    type(coupling_settings_t) :: settings
    type(scene_t) :: scene
    type(cloud_t) :: cloud
    real(wp), allocatable :: expected(:,:,:,:), given(:,:,:,:)
    real(wp) :: force(3)
    integer :: a

    call build(comm, 0.1_wp, n, periodic, 'gidaspow', scene)
    if (present(mapping)) settings%mapping = mapping
    if (present(width)) settings%width = width
    if (present(mapping) .or. present(width)) call recouple(scene, settings)
    call make_cloud(cloud)
    call add_cloud(cloud, scene)
    call stir(scene)
    call scene%coupling%map_void_fraction(scene%parcels, scene%gas)
    call scene%coupling%prepare(scene%parcels, scene%gas, dt, as_seen=.false.)
    call direct_sum(scene, cloud, settings, expected, force)
    allocate (given, mold=expected)
    associate (m => scene%boxes%n)
      given(4, :, :, :) = on_all_ranks(scene, scene%gas%drag(1:m(1), 1:m(2), 1:m(3)))
      given(5, :, :, :) = on_all_ranks(scene, scene%gas%eps(1:m(1), 1:m(2), 1:m(3)))
      do a = 1, 3
        given(a, :, :, :) = on_all_ranks(scene, scene%gas%drag_source(a, 1:m(1), 1:m(2), 1:m(3)))
      end do
    end associate
    call scene%coupling%drive(scene%parcels, scene%gas, dt)
    if (.not. comm%is_root()) return
    call expect_close(maxval(abs(given(5, :, :, :) - expected(5, :, :, :))), 0.0_wp, 1e-12_wp, 'void fraction, '//name)
    do a = 1, 4
      call expect(maxval(abs(given(a, :, :, :) - expected(a, :, :, :))) < 1e-12_wp*maxval(abs(expected(a, :, :, :))), &
        trim(merge('coefficient of drag, ', 'source of drag,      ', a == 4))//' '//name)
    end do
    associate (exchange => scene%coupling%exchange)
      call expect_close(exchange%momentum_residual, 0.0_wp, 1e-13_wp, 'momentum given is momentum taken, '//name)
      call expect(all(abs(exchange%drag - force) < 1e-12_wp*maxval(abs(force))), 'drag on all parcels, '//name)
      call expect_close(exchange%solids_volume, sum(cloud%weight*pi/6*cloud%diameter**3), 1e-13_wp, 'volume, '//name)
      call expect_close(sum(1 - given(5, :, :, :))*product(scene%mesh%finest), exchange%solids_volume, 1e-12_wp, &
        'no volume is lost, '//name)
      call expect_close(exchange%least_void_fraction, minval(expected(5, :, :, :)), 1e-12_wp, 'least void fraction, '//name)
      call expect(all(exchange%worst_cell == minloc(expected(5, :, :, :))), 'and where, '//name)
      call expect(exchange%clipped_cells == 0, 'nothing is clipped, '//name)
    end associate
  end subroutine check_cloud

  !> 0.1-0.6 mm grains, 1 to 9 per parcel, spread over the whole domain of 0.1 x 0.2 x 0.1 m; half have a past.
  subroutine make_cloud(cloud)
    type(cloud_t), intent(out) :: cloud

    real(wp), parameter :: step(8) = [0.8191725134_wp, 0.6710436067_wp, 0.5497004779_wp, 0.4142135624_wp, &
      0.7320508076_wp, 0.2360679775_wp, 0.6457513111_wp, 0.3166247904_wp]
    real(wp) :: r(8)
    integer :: m

    do m = 1, total
      r = modulo(m*step, 1.0_wp)
      cloud%x(:, m) = r(1:3)*[0.1_wp, 0.2_wp, 0.1_wp]
      cloud%moved(:, m) = 0.00199_wp*(2*r(4:6) - 1)
      cloud%velocity(:, m) = r(6:8) - 0.5_wp
      cloud%before(:, m) = r([5, 7, 6]) - 0.5_wp
      cloud%drag(:, m) = 10*(r([7, 4, 2]) - 0.4_wp)
      cloud%diameter(m) = 1.0e-4_wp + 5.0e-4_wp*r(7)
      cloud%weight(m) = 1 + 8*r(8)
      cloud%new(m) = modulo(m, 2) == 0
    end do
  end subroutine make_cloud

  subroutine add_cloud(cloud, scene)
    type(cloud_t), intent(in) :: cloud
    type(scene_t), intent(inout) :: scene

    integer :: m, n

    do m = 1, total
      n = scene%parcels%n
      call add(scene, cloud%x(:, m), cloud%moved(:, m), cloud%diameter(m), solid_density, cloud%weight(m))
      if (scene%parcels%n == n) cycle
      associate (coupled => scene%parcels%coupled(:, n + 1))
        scene%parcels%state(velocity_row:velocity_row + 2, n + 1) = cloud%velocity(:, m)
        if (cloud%new(m)) cycle
        coupled(before_row:before_row + 3) = [cloud%before(:, m), dt_before]
        coupled(drag_row:drag_row + 2) = cloud%drag(:, m)
      end associate
    end do
  end subroutine add_cloud

  !> Some velocity and pressure everywhere.
  subroutine stir(scene)
    type(scene_t), intent(inout) :: scene

    integer :: i, j, k, a
    real(wp) :: phase

    associate (gas => scene%gas)
      do k = 1, scene%boxes%n(3)
        do j = 1, scene%boxes%n(2)
          do i = 1, scene%boxes%n(1)
            phase = dot_product(scene%boxes%lo + [i, j, k], [1.1_wp, 0.7_wp, 0.3_wp])
            gas%velocity(i, j, k, :) = [(sin(phase + a), a=1, 3)]*gas%free(i, j, k, :)
            gas%pressure(i, j, k) = 10*sin(3*phase)
          end do
        end do
      end do
      call gas%halo%exchange_many(gas%velocity)
      call gas%halo%exchange(gas%pressure)
    end associate
  end subroutine stir

  !> A field of my box as part of the field of the whole grid.
  function on_all_ranks(scene, part) result(whole)
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: part(:,:,:)
    real(wp), allocatable :: whole(:,:,:)

    associate (n => scene%mesh%n, lo => scene%boxes%lo, hi => scene%boxes%hi)
      allocate (whole(n(1), n(2), n(3)), source=0.0_wp)
      whole(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)) = part
      whole = reshape(comm%sum(reshape(whole, [size(whole)])), shape(whole))
    end associate
  end function on_all_ranks

  !> Source 1:3, coefficient of drag 4 and void fraction 5 of every cell, and the force on all parcels, each parcel
  !> taken by itself and cells found by their distance.
  subroutine direct_sum(scene, cloud, settings, expected, force)
    type(scene_t), intent(in) :: scene
    type(cloud_t), intent(in) :: cloud
    type(coupling_settings_t), intent(in) :: settings
    real(wp), allocatable, intent(out) :: expected(:,:,:,:)
    real(wp), intent(out) :: force(3)

    real(wp), allocatable :: w(:,:,:), u(:,:,:,:), gradient(:,:,:,:), field(:,:,:,:)
    real(wp) :: eps, slip(3), volume, mass, acceleration(3), rate, part, lead, beta, v_hat(3)
    integer :: m, a

    associate (n => scene%mesh%n, b => scene%boxes%n)
      allocate (expected(5, n(1), n(2), n(3)), source=0.0_wp)
      allocate (u(n(1), n(2), n(3), 3), gradient(n(1), n(2), n(3), 3), field(3, b(1), b(2), b(3)))
    end associate
    call scene%gas%cell_velocity(field)
    do a = 1, 3
      u(:, :, :, a) = on_all_ranks(scene, field(a, :, :, :))
    end do
    call scene%gas%cell_pressure_gradient(field)
    do a = 1, 3
      gradient(:, :, :, a) = on_all_ranks(scene, field(a, :, :, :))
    end do
    expected(5, :, :, :) = 1.0_wp
    do m = 1, total
      volume = pi/6*cloud%diameter(m)**3
      expected(5, :, :, :) = expected(5, :, :, :) &
        - weights(scene%mesh, settings, cloud%x(:, m) + cloud%moved(:, m))*cloud%weight(m)*volume/product(scene%mesh%finest)
    end do
    force = 0.0_wp
    do m = 1, total
      volume = pi/6*cloud%diameter(m)**3
      mass = solid_density*volume
      w = weights(scene%mesh, settings, cloud%x(:, m) + cloud%moved(:, m))
      eps = sum(w*expected(5, :, :, :))
      slip = [(sum(w*u(:, :, :, a)), a=1, 3)]
      acceleration = (cloud%velocity(:, m) - cloud%before(:, m))/dt_before - cloud%drag(:, m)/eps
      if (cloud%new(m)) acceleration = gravity - [(sum(w*gradient(:, :, :, a)), a=1, 3)]/solid_density
      slip = slip - cloud%velocity(:, m)
      rate = relaxation_rate(cloud%diameter(m), mass, eps, slip)
      call exact_shares(dt*rate, part, lead)
      rate = relaxation_rate(cloud%diameter(m), mass, eps, slip - part*(slip + acceleration/rate)/2)
      call exact_shares(dt*rate, part, lead)
      slip = slip + cloud%velocity(:, m)
      v_hat = cloud%velocity(:, m) + acceleration*lead*dt
      beta = cloud%weight(m)*eps*mass*part/dt
      force = force + beta*(slip - v_hat)
      expected(4, :, :, :) = expected(4, :, :, :) + w*beta
      do a = 1, 3
        expected(a, :, :, :) = expected(a, :, :, :) + w*beta*v_hat(a)
      end do
    end do
  end subroutine direct_sum

  !> 1/tau of a particle and the pressure gradient of its drag [1/s].
  pure function relaxation_rate(diameter, mass, eps, slip) result(rate)
    real(wp), intent(in) :: diameter, mass, eps, slip(3)
    real(wp) :: rate

    rate = 3*pi*viscosity*diameter/mass*gidaspow(density*eps*norm2(slip)*diameter/viscosity, eps)
  end function relaxation_rate

  !> 1 - exp(-x), and its inverse less 1/x, in quadruple precision.
  pure subroutine exact_shares(x, r, q)
    real(wp), intent(in) :: x
    real(wp), intent(out) :: r, q

    integer, parameter :: quadruple = selected_real_kind(30)
    real(quadruple) :: y

    y = 1.0_quadruple - exp(-real(x, quadruple))
    r = real(y, wp)
    q = real(1.0_quadruple/y - 1.0_quadruple/x, wp)
  end subroutine exact_shares

  !> The weight of every cell of the grid for a parcel: the distance to its centre, or that of its nearest image, in
  !> each direction; beyond the outermost centres between walls, the outermost cell alone. Or the cell that it is in.
  !> Spread by width, if there is one.
  function weights(mesh, settings, x) result(w)
    type(mesh_t), intent(in) :: mesh
    type(coupling_settings_t), intent(in) :: settings
    real(wp), intent(in) :: x(3)
    real(wp) :: w(mesh%n(1), mesh%n(2), mesh%n(3))

    real(wp) :: s, one(maxval(mesh%n), 3)
    integer :: a, c, i, j, k, image

    one = 0.0_wp
    do a = 1, 3
      s = (x(a) - mesh%lower(a))/mesh%finest(a) + 0.5_wp
      if (.not. mesh%periodic(a)) s = min(max(s, 1.0_wp), real(mesh%n(a), wp))
      if (settings%mapping == 'cell') s = anint(s)
      do c = 1, mesh%n(a)
        do image = -1, 1
          if (image /= 0 .and. .not. mesh%periodic(a)) cycle
          one(c, a) = one(c, a) + max(0.0_wp, 1 - abs(s - c - image*mesh%n(a)))
        end do
      end do
      if (is_set(settings%width)) one(:mesh%n(a), a) = widened(mesh, a, settings, one(:mesh%n(a), a))
    end do
    do k = 1, mesh%n(3)
      do j = 1, mesh%n(2)
        do i = 1, mesh%n(1)
          w(i, j, k) = one(i, 1)*one(j, 2)*one(k, 3)
        end do
      end do
    end do
  end function weights

  !> Shares of the cells of a row, each gone where diffusion takes it.
  function widened(mesh, a, settings, share) result(wide)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: a           !< direction of the row
    type(coupling_settings_t), intent(in) :: settings
    real(wp), intent(in) :: share(:)
    real(wp) :: wide(size(share))

    real(wp) :: h(size(share)), mapped
    real(wp), allocatable :: row(:)
    integer :: i, m, reach, to

    wide = share
    if (size(share) == 1) return
    h = mesh%finest(a)
    mapped = merge(1.0_wp/12, 1.0_wp/6, settings%mapping == 'cell')
    reach = kernel_reach(h, settings%width)
    wide = 0.0_wp
    do i = 1, size(share)
      row = kernel_row(h, mesh%periodic(a), settings%width, mapped, i, reach)
      do m = -reach, reach
        to = modulo(i + m - 1, size(share)) + 1
        wide(to) = wide(to) + share(i)*row(m + reach + 1)
      end do
    end do
  end function widened

  !> Ten parcels in the middle of one cell hold more than the cell: the gas sees the least void fraction, and the
  !> ledger says what it does not see.
  subroutine check_clipping()
    type(scene_t) :: scene
    real(wp) :: volume, seen
    integer :: i

    call build(comm, 0.1_wp, [8, 12, 6], [.false., .false., .false.], 'beetstra', scene)
    do i = 1, 10
      call add(scene, scene%mesh%finest*([3, 7, 2] - 0.5_wp), spread(0.0_wp, 1, 3), 1.0e-3_wp, solid_density, 1000.0_wp)
    end do
    volume = 10*1000*pi/6*1.0e-9_wp
    call scene%coupling%map_void_fraction(scene%parcels, scene%gas)
    associate (n => scene%boxes%n)
      seen = comm%sum(sum(1 - scene%gas%eps(1:n(1), 1:n(2), 1:n(3)))*product(scene%mesh%finest))
    end associate
    call scene%coupling%prepare(scene%parcels, scene%gas, dt, as_seen=.false.)
    call scene%coupling%drive(scene%parcels, scene%gas, dt)
    if (.not. comm%is_root()) return
    associate (exchange => scene%coupling%exchange)
      call expect_close(seen, 0.7_wp*product(scene%mesh%finest), 1e-12_wp, 'the gas sees the least void fraction')
      call expect_close(exchange%clipped_volume, volume - 0.7_wp*product(scene%mesh%finest), 1e-12_wp, 'the rest is recorded')
      call expect_close(exchange%least_void_fraction, 1 - volume/product(scene%mesh%finest), 1e-12_wp, 'and how bad it is')
      call expect(exchange%clipped_cells == 1 .and. all(exchange%worst_cell == [3, 7, 2]), 'and where')
    end associate
  end subroutine check_clipping

end program test_coupling_cloud
