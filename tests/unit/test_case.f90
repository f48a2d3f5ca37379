!> Case files as text: what is read, what is in effect, and how the command line changes it.
program test_case
  use case, only: case_t
  use case_reading, only: read_case_text
  use check, only: expect, expect_close, finish
  use command_line, only: command_line_t, parse_arguments
  use constants, only: is_set
  use kinds, only: wp
  use parcel_plan, only: parcel_plan_t, new_parcel_plan, shortest_contact
  use outcome, only: outcome_t
  use problems, only: problems_t
  use text, only: string_t, shown, nearest_name
  implicit none

  character(len=1), parameter :: nl = achar(10), cr = achar(13), tab = achar(9)
  character(len=256), parameter :: none(0) = ' '
  character(len=*), parameter :: bed = &
    '&run end_time = 1 /'//nl// &
    '&domain lower = 0, 0, 0, upper = 0.1, 0.4, 0.02 /'//nl// &
    '&gas viscosity = 2e-5 / &grid cells = 10, 40, 2 /'//nl// &
    '&boundary id = ''in'', kind = ''inflow'', velocity = 0.4, lower = 3*0, upper = 0.1, 0, 0.02 /'//nl// &
    '&boundary id = ''out'', kind = ''outflow'', lower = 0, 0.4, 0, upper = 0.1, 0.4, 0.02 /'//nl// &
    '&powder id = ''glass'', density = 2500, mean_diameter = 1e-3 /'//nl// &
    '&parcels weighting = ''ssw'', weight = 8 /'//nl// &
    '&fill id = ''bed'', powder = ''glass'', mass = 0.2, lower = 0, 0, 0, upper = 0.1, 0.1, 0.02 /'//nl// &
    '&contact stiffness = 100 /'//nl

  call test_values()
  call test_resolved()
  call test_overrides()
  call test_plan()
  call test_tolerance()
  call test_arguments()
  call test_texts()
  call finish()

contains

  subroutine read(text, overrides, scene, problems)
    character(len=*), intent(in) :: text, overrides(:)
    type(case_t), intent(out) :: scene
    type(problems_t), intent(out) :: problems

    integer :: i

    call read_case_text(text, overrides, scene, problems)
    do i = 1, problems%count()
      print '(2a)', '  ', problems%message(i)
    end do
  end subroutine read

  subroutine test_values()
    type(case_t) :: scene
    type(problems_t) :: problems

    call read(bed, none, scene, problems)
    call expect(problems%count() == 0, 'a good case has no problems')
    call expect_close(scene%run%end_time, 1.0_wp, 0.0_wp, 'a real')
    call expect_close(scene%gas%viscosity, 2.0e-5_wp, 0.0_wp, 'a real with an exponent')
    call expect_close(scene%gas%density, 1.2_wp, 0.0_wp, 'a default')
    call expect_close(scene%domain%upper(2), 0.4_wp, 0.0_wp, 'an array')
    call expect(all(scene%domain%cells == [10, 40, 2]), 'integers')
    call expect(scene%gas%present .and. scene%with_gas .and. scene%with_parcels, 'what there is is known')
    call expect(size(scene%boundaries) == 2 .and. scene%boundaries(2)%kind == 'outflow', 'records in order')
    call expect(.not. is_set(scene%boundaries(2)%velocity), 'a key that is not given stays unset')
    call expect(scene%fills(1)%powder == 1, 'a reference finds its record')
  end subroutine test_values

  !> The text of a resolved case is a case file with the same meaning.
  subroutine test_resolved()
    type(case_t) :: scene, again, ideal
    type(problems_t) :: problems

    call read(bed//'&numerics tolerance = 0.01234567890123456 /', none, scene, problems)
    call expect(index(scene%text, 'restitution = 0.9') > 0, 'the resolved case holds defaults')
    call expect(index(scene%text, 'wall_stiffness') == 0, 'the resolved case leaves out what is unset')
    call read(scene%text, none, again, problems)
    call expect(problems%count() == 0, 'the resolved case can be read')
    call expect(scene%text == again%text, 'and means the same')
    call read(bed, [character(len=256) :: 'gas%density_law=ideal', 'gas%molar_mass=0.029', 'gas%temperature=300', &
                    'gas%pressure=1e5'], ideal, problems)
    call expect(problems%count() == 0, 'a case with an ideal gas is good')
    call expect_close(ideal%gas%density, 1.0e5_wp*0.029_wp/(8.31446261815324_wp*300), 1.0e-14_wp, 'its density')
    call read(ideal%text, none, scene, problems)
    call expect(problems%count() == 0, 'and so is its resolved case')
    call read(bed, [character(len=256) :: 'gas%turbulence_model=smagorinsky'], ideal, problems)
    call expect_close(ideal%gas%smagorinsky_constant, 0.17_wp, 0.0_wp, 'a constant of eddies that is not given')
    call read(ideal%text, none, scene, problems)
    call expect(problems%count() == 0, 'a resolved case with eddies is good')
    call expect_close(again%contact%tangential_ratio, 2.0_wp/7.0_wp, 0.0_wp, 'to the last bit')
    call expect_close(again%gas_numerics%tolerance, 0.01234567890123456_wp, 0.0_wp, 'with all digits')
  end subroutine test_resolved

  subroutine test_overrides()
    type(case_t) :: scene
    type(problems_t) :: problems

    call read(bed, [character(len=40) :: 'parcels%weight=27', 'contact%friction = 0.3', 'fill(bed)%mass=0.1', &
                    'boundary(1)%velocity=0.5', 'run%title=it is, / new', 'coupling%drag=beetstra', &
                    'grid%cells=5,20,1', 'domain%periodic=f f t'], scene, problems)
    call expect(problems%count() == 0, 'overrides are read')
    call expect_close(scene%parcels%weight, 27.0_wp, 0.0_wp, 'a key is replaced')
    call expect_close(scene%contact%friction, 0.3_wp, 0.0_wp, 'a key is added')
    call expect_close(scene%fills(1)%mass, 0.1_wp, 0.0_wp, 'a record is found by its id')
    call expect_close(scene%boundaries(1)%velocity, 0.5_wp, 0.0_wp, 'and by its number')
    call expect(scene%run%title == 'it is, / new', 'a text needs no quotes')
    call expect(scene%coupling%drag == 'beetstra', 'a group is added')
    call expect(all(scene%domain%cells == [5, 20, 1]) .and. scene%domain%periodic(3), 'arrays')
    call read(bed, [character(len=40) :: 'fill(heap)%mass=0.1', 'boundary%velocity=1', 'end_time=2'], scene, problems)
    call expect(problems%count() == 3, 'overrides that mean no record')
  end subroutine test_overrides

  !> 0.2 kg of 8 particles of 1 mm each.
  subroutine test_plan()
    type(case_t) :: scene
    type(problems_t) :: problems
    type(parcel_plan_t) :: plan
    type(outcome_t) :: outcome
    real(wp), parameter :: mass = 8*2500*acos(-1.0_wp)/6*1.0e-9_wp

    call read(bed, none, scene, problems)
    call new_parcel_plan(scene, 1, plan, outcome)
    call expect_close(plan%parcels, 0.2_wp/mass, 1.0e-12_wp, 'parcels')
    call expect_close(plan%diameter(2), 2.0e-3_wp, 1.0e-12_wp, 'their diameter')
    call expect_close(shortest_contact(scene, [plan]), sqrt((acos(-1.0_wp)**2 + log(0.9_wp)**2)*mass/2/100), 1.0e-12_wp, &
                      'their collision')
    call read(bed, ['parcels%weighting=ssp   ', 'parcels%diameter=0.00133'], scene, problems)
    call new_parcel_plan(scene, 1, plan, outcome)
    call expect_close(plan%weight(1), 1.33_wp**3, 1.0e-12_wp, 'weight of ssp')
    call expect_close(plan%parcels, 8*0.2_wp/mass/1.33_wp**3, 1.0e-12_wp, 'parcels of ssp')
  end subroutine test_plan

  !> What editors and other systems leave in files.
  subroutine test_tolerance()
    type(case_t) :: scene
    type(problems_t) :: problems

    call read(char(239)//char(187)//char(191)//'&run'//cr//nl//tab//'end_time=2,'//cr//nl//'/'//cr//nl// &
              'Free text: 50 % of it, & more, "unclosed'//cr//nl//bed(21:), none, scene, problems)
    call expect(problems%count() == 0, 'carriage returns, tabs and a byte order mark')
    call expect_close(scene%run%end_time, 2.0_wp, 0.0_wp, 'do not change values')
    call read(bed(:len(bed) - 3), none, scene, problems)
    call expect(problems%count() == 1, 'a file that ends inside a record')
    call read('', none, scene, problems)
    call expect(problems%count() == 3, 'an empty file')
    call read(bed//'&fill /&fill = 3, x /&coupling drag drag = /&grid cells = cells(1) = /', none, scene, problems)
    call expect(problems%count() > 5, 'nonsense')
  end subroutine test_tolerance

  subroutine test_arguments()
    type(command_line_t) :: command
    type(problems_t) :: problems
    type(string_t) :: arguments(9)
    integer :: i
    character(len=20), parameter :: words(9) = [character(len=20) :: '--set', 'a%b=1', 'x.nml', '--out', 'there', &
                                                '--set=c%d=2', '--restart=r.h5', '--force', '--check']

    do i = 1, size(words)
      arguments(i)%text = trim(words(i))
    end do
    call parse_arguments(arguments, command, problems)
    call expect(problems%count() == 0 .and. command%case_file == 'x.nml', 'the case file among options')
    call expect(size(command%overrides) == 2, 'overrides')
    if (size(command%overrides) == 2) call expect(all(command%overrides == ['a%b=1', 'c%d=2']), 'as they are')
    call expect(command%out == 'there' .and. command%restart == 'r.h5', 'options with values')
    call expect(command%force .and. command%check .and. .not. command%help, 'options without')
    arguments(1)%text = '--help'
    arguments(2)%text = '&gas'
    call parse_arguments(arguments(:2), command, problems)
    call expect(problems%count() == 0 .and. command%help .and. command%help_group == 'gas', '--help &gas')
    call parse_arguments(arguments(4:4), command, problems)
    call expect(problems%count() == 2, 'a value and a case file that are missing')
  end subroutine test_arguments

  subroutine test_texts()
    type(string_t) :: names(3)

    call expect(shown(0.1_wp) == '0.1' .and. shown(1.0_wp/3.0_wp) == '0.3333333333333333', 'the fewest digits')
    call expect(shown(-2500.0_wp) == '-2500' .and. shown(1.8e-5_wp) == '1.8e-5' .and. shown(0.0_wp) == '0', 'plain')
    call expect(shown(1.0e22_wp) == '1e22' .and. shown(12.5_wp) == '12.5' .and. shown(0.0015_wp) == '0.0015', 'numbers')
    call expect(shown([1.0_wp, 2.0_wp]) == '1, 2' .and. shown('it''s') == '''it''''s''', 'lists and texts')
    names(1)%text = 'density'
    names(2)%text = 'viscosity'
    names(3)%text = 'mean_diameter'
    call expect(nearest_name('dnesity', names) == 1, 'swapped letters')
    call expect(nearest_name('viscocity', names) == 2, 'a wrong letter')
    call expect(nearest_name('diameter', names) == 3, 'half a name')
    call expect(nearest_name('pressure', names) == 0, 'nothing near')
  end subroutine test_texts

end program test_case
